"""An estimate of the shear."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from uvshear.estimators.with_error import with_error

SKY: Final = "sky"
"""Frame of local North at each source: g1 and g2 in TreeCorr's convention for (RA, Dec)."""


@dataclass(frozen=True)
class ShearConditions:
    """What the bias of a shear depends on: the estimator with its assumptions, the selection, and the facets.

    Parameters
    ----------
    estimator
        Name of the estimator.
    assumed
        Assumptions of the estimator, as names and values for a JSON file (``Estimator.record``).
    snr_min
        Signal-to-noise ratio below which sources are left out.
    flux_min
        Catalogue's flux below which sources are left out [Jy].
    averages_cells
        Whether the facets are the paper's, which average in uv cells.
    detection_min
        Significance below which sources are left out.
    """

    estimator: str
    assumed: Mapping[str, object] = field(default_factory=dict)
    snr_min: float = 0.0
    flux_min: float = 0.0
    averages_cells: bool = False
    detection_min: float = 0.0

    @property
    def prior(self) -> str:
        """Origin of the population that the estimator assumes; ``paper`` where it assumes none."""
        return str(self.assumed.get("prior", "paper"))

    @property
    def wraps(self) -> str:
        """Name of the estimator that this one wraps; ``none`` if it wraps none."""
        return str(self.assumed.get("wraps", "none"))


@dataclass(frozen=True)
class ShearEstimate:
    """Reduced shear with its standard errors.

    Parameters
    ----------
    g1, g1_err, g2, g2_err
        Components and their standard errors.
    n
        Number of sources that contribute.
    estimator
        Name of the estimator.
    frame
        Frame of the components; "sky" is that of local North.
    bins
        Shear of the sources in each bin of the catalogue's flux, by the name of the bin.
    assumed
        Assumptions of the estimator, as names and values for a JSON file.
    seed
        Seed of the random numbers of the estimator; None if it uses none.
    conditions
        Estimator, cuts and facets; None for the shear of a sample of unknown selection, and for bins.
    correction
        Name of the bias that has been removed: its file, or "the bias" if it was given as an object; None if none has
        been removed.
    """

    g1: float
    g1_err: float
    g2: float
    g2_err: float
    n: int
    estimator: str
    frame: str = SKY
    bins: Mapping[str, "ShearEstimate"] = field(default_factory=dict, repr=False)
    assumed: Mapping[str, object] = field(default_factory=dict, repr=False)
    seed: int | None = field(default=None, repr=False)
    conditions: ShearConditions | None = field(default=None, repr=False)
    correction: str | None = field(default=None, repr=False)

    @property
    def shear(self) -> complex:
        """The shear as a complex number g1 + i g2."""
        return complex(self.g1, self.g2)

    def numbers(self) -> dict[str, float | int | str]:
        """Return the numbers of the estimate by name, without those of its bins."""
        names = ("g1", "g1_err", "g2", "g2_err", "n", "estimator", "frame")
        return {name: getattr(self, name) for name in names}

    def __str__(self) -> str:
        return (
            f"g1 = {with_error(self.g1, self.g1_err)}, g2 = {with_error(self.g2, self.g2_err)}"
            f" ({self.estimator}, {self.n} galaxies)"
        )
