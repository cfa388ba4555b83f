"""An estimate of the shear."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from uvshear.estimators.goodness import PopulationGoodness
from uvshear.estimators.with_error import with_error

SINGLE_GALAXY: Final = 0.3
"""Standard error of the shear from the ellipticity of one galaxy, whose components have a standard deviation of 0.25 in
the population of Rivi & Miller 2018. A larger one says that the responses of the galaxies nearly cancel."""

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
    goodness
        How well the population fits that the estimator assumes; None if it assumes none.
    remarks
        What a user should know about the estimate, one sentence each.
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
    goodness: PopulationGoodness | None = field(default=None, repr=False)
    remarks: tuple[str, ...] = field(default=(), repr=False)

    @property
    def error(self) -> float:
        """The larger standard error of both components; infinite if one of them is not known."""
        largest = max(self.g1_err, self.g2_err)
        return largest if math.isfinite(self.g1_err + self.g2_err) else math.inf

    @property
    def is_determined(self) -> bool:
        """Whether the shear is known better than from the ellipticity of a single galaxy."""
        return self.error < SINGLE_GALAXY

    @property
    def shear(self) -> complex:
        """The shear as a complex number g1 + i g2."""
        return complex(self.g1, self.g2)

    def with_remarks(self, all_bins: Mapping[str, "ShearEstimate"]) -> "ShearEstimate":
        """Return the estimate with remarks on what does not determine it and on a population that does not fit.

        Parameters
        ----------
        all_bins
            Every bin of flux, with those that are left out of the estimate.
        """
        remarks = []
        if self.goodness is not None and (reasons := self.goodness.reasons):
            prior = str(self.assumed.get("prior", "assumed"))
            advice = "" if prior == "fitted" else "--prior fitted, "
            remarks.append(
                f"the assumed population ({prior}) does not fit these galaxies: {_listed(reasons)}; the shear may be"
                f" wrong by more than its error; use {advice}--prior FILE or --estimator moments"
            )
        unknown = {"these galaxies": self} | {
            f"the galaxies of {k}": v for k, v in all_bins.items()
        }
        for name, part in unknown.items():
            if not part.is_determined:
                remarks.append(
                    f"{name} do not determine a shear: its standard error is {part.error:.2g}, whereas that from the"
                    f" ellipticity of a single galaxy is {SINGLE_GALAXY:g}; use more galaxies or another --estimator"
                    + ("" if part is self else "; this bin is left out")
                )
        return replace(self, remarks=tuple(remarks))

    def numbers(self) -> dict[str, float | int | str]:
        """Return the numbers of the estimate by name, without those of its bins."""
        names = ("g1", "g1_err", "g2", "g2_err", "n", "estimator", "frame")
        return {name: getattr(self, name) for name in names}

    def __str__(self) -> str:
        return (
            f"g1 = {with_error(self.g1, self.g1_err)}, g2 = {with_error(self.g2, self.g2_err)}"
            f" ({self.estimator}, {self.n} galaxies)"
        )


def _listed(parts: Sequence[str]) -> str:
    """Return clauses as a list in one sentence."""
    *first, last = parts
    return f"{', '.join(first)} and {last}" if first else last
