"""Galaxies of a simulated survey, drawn from distributions of flux, size and shape."""

from dataclasses import dataclass, field

import numpy as np

from uvshear.constants import ARCMIN, SPECTRAL_INDEX
from uvshear.errors import InputError
from uvshear.galaxy.ellipticity_prior import DiscEllipticityPrior, EllipticityPrior
from uvshear.galaxy.flux import PowerLawFlux
from uvshear.galaxy.galaxies import Galaxies
from uvshear.galaxy.size import SizeFluxRelation
from uvshear.simulation.sky_region import SkyRegion

PAPER_DENSITY = 2.7 / ARCMIN**2
"""Number of galaxies between 10 and 200 uJy per steradian (Rivi & Miller 2018, section 3)."""


@dataclass(frozen=True)
class Population:
    """Distributions to draw galaxies from; by default those of Rivi & Miller 2018, section 3.

    Parameters
    ----------
    flux, size, ellipticity
        Distribution of the flux, of the scale length at a flux, and of abs(e).
    ring
        Number of galaxies that share flux, scale length and abs(e), with e equally spaced on the circle, so that the
        mean e of the ring is 0 ("free of shape noise"); the paper has 10. Their positions are independent. With 1 all
        galaxies are independent.
    spectral_index
        Spectral index of every galaxy.
    """

    flux: PowerLawFlux = field(default_factory=PowerLawFlux)
    size: SizeFluxRelation = field(default_factory=SizeFluxRelation)
    ellipticity: EllipticityPrior = field(default_factory=DiscEllipticityPrior)
    ring: int = 1
    spectral_index: float = SPECTRAL_INDEX

    def __post_init__(self) -> None:
        if self.ring < 1:
            raise InputError(f"population: ring is {self.ring}; it must be 1 or more")


def expected_number(sky: SkyRegion, density: float, *, ring: int = 1) -> int:
    """Return the expected number of galaxies in a region, rounded to the nearest whole ring.

    It is not drawn from a Poisson distribution, so that repeated simulations have the same size.

    Parameters
    ----------
    density
        Number of galaxies per steradian.
    ring
        Number of galaxies in a ring.
    """
    return ring * round(density * sky.area / ring)


def draw_population(
    population: Population, sky: SkyRegion, *, number: int, rng: np.random.Generator
) -> Galaxies:
    """Draw galaxies; those of a ring follow each other.

    Parameters
    ----------
    number
        Number of galaxies, a multiple of the size of a ring; :func:`expected_number` gives it for a density.
    """
    rings, rest = divmod(number, population.ring)
    if rest:
        raise InputError(
            f"population: {number} galaxies do not make whole rings of {population.ring}"
        )
    flux = population.flux.draw(rings, rng)
    scale_length = population.size.draw(flux, rng)
    modulus = population.ellipticity.draw_modulus(rings, rng)
    start = rng.uniform(0, 2 * np.pi, rings)
    phase = start[:, None] + 2 * np.pi * np.arange(population.ring) / population.ring
    l, m = sky.draw(number, rng)
    return Galaxies(
        l=l,
        m=m,
        flux=np.repeat(flux, population.ring),
        scale_length=np.repeat(scale_length, population.ring),
        ellipticity=(modulus[:, None] * np.exp(1j * phase)).ravel(),
        spectral_index=np.full(number, population.spectral_index),
    )
