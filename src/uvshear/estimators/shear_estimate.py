"""An estimate of the shear."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

SKY: Final = "sky"
"""Frame of local North at each source: g1 and g2 in TreeCorr's convention for (RA, Dec)."""


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
            f"g1 = {self.g1:+.5f} +- {self.g1_err:.5f}, g2 = {self.g2:+.5f} +- {self.g2_err:.5f}"
            f" ({self.estimator}, {self.n} galaxies)"
        )
