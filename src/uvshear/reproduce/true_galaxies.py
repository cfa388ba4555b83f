"""Galaxies that are drawn from the population, and their division into parts of a computation."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.galaxy.size import SizePrior
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.simulation.population import Population
from uvshear.typing import Array, Complex, Float


def blocks_of_galaxies(galaxies: int, block: int) -> Mapping[str, tuple[int, int]]:
    """Return the first galaxy and the number of galaxies of each part, by its name."""
    return {
        f"galaxies-{first}": (first, min(block, galaxies - first))
        for first in range(0, galaxies, block)
    }


@dataclass(frozen=True)
class TrueGalaxies:
    """Galaxies of random flux, size and ellipticity at the phase centre.

    Parameters
    ----------
    flux
        Fluxes [Jy].
    scale_length
        Scale lengths [rad].
    ellipticity
        Ellipticities e1 + i e2.
    size
        Prior on the scale lengths.
    """

    flux: Float[Array, " galaxy"]
    scale_length: Float[Array, " galaxy"]
    ellipticity: Complex[Array, " galaxy"]
    size: SizePrior

    @classmethod
    def draw(cls, population: Population, number: int, rng: np.random.Generator) -> Self:
        """Draw galaxies of a population."""
        flux = population.flux.draw(number, rng)
        size = population.size.prior(flux)
        scale_length = size.draw(rng)
        modulus = population.ellipticity.draw_modulus(number, rng)
        return cls(
            flux, scale_length, modulus * np.exp(2j * np.pi * rng.uniform(size=number)), size
        )

    def galaxy(self, number: int) -> GalaxyFit:
        """Return a galaxy."""
        e, scale_length = complex(self.ellipticity[number]), float(self.scale_length[number])
        return GalaxyFit(float(self.flux[number]), np.zeros(2), e, scale_length, 0.0)

    def prior(self, number: int) -> ShapePrior:
        """Return the prior with which the galaxy is measured."""
        return ShapePrior(float(self.size.log_median[number]), float(self.size.sigma[number]))
