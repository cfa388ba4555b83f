"""Distribution of flux densities: counts that fall as a power of the flux."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.constants import MICROJANSKY
from uvshear.errors import InputError
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class PowerLawFlux:
    r"""Power law of flux densities between two bounds.

    .. math:: p(S) \propto S^{-1.34}

    Parameters
    ----------
    index
        Exponent of the density per unit flux; -1 is allowed.
    minimum, maximum
        Bounds of the flux density [Jy].

    References
    ----------
    Rivi & Miller 2018, section 3; the index is from the SWIRE field, at 10 to 200 uJy and 1.4 GHz.
    """

    index: float = -1.34
    minimum: float = 10 * MICROJANSKY
    maximum: float = 200 * MICROJANSKY

    def __post_init__(self) -> None:
        if not 0 < self.minimum < self.maximum:
            raise InputError(
                f"flux distribution: the bounds are {self.minimum} and {self.maximum} Jy;"
                " the minimum must be positive and below the maximum"
            )

    def density(self, flux: Float[Array, " source"]) -> Float[Array, " source"]:
        """Density per jansky; 0 outside the bounds."""
        inside = (flux >= self.minimum) & (flux <= self.maximum)
        x = np.where(inside, flux / self.minimum, 1.0)
        return np.where(inside, x**self.index / (self.minimum * self._integral), 0.0)

    def draw(self, number: int, rng: np.random.Generator) -> Float[Array, " source"]:
        """Draw flux densities [Jy], using the inverse of their cumulative distribution."""
        mass = rng.uniform(size=number) * self._integral
        power = self.index + 1
        x = np.exp(mass) if power == 0 else (1 + power * mass) ** (1 / power)
        return np.clip(self.minimum * x, self.minimum, self.maximum)

    @property
    def _integral(self) -> float:
        """Integral of x^index from 1 to maximum/minimum."""
        ratio, power = self.maximum / self.minimum, self.index + 1
        return math.log(ratio) if power == 0 else (ratio**power - 1) / power
