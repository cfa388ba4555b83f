"""Realisations of a galaxy and its noise, in whose average both cancel."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from uvshear.bias.mock_facets import FacetNoise, FacetSimulator
from uvshear.galaxy import Galaxies


@dataclass(frozen=True)
class Realisation:
    """Transformation of galaxies before they are lensed, and of their noise.

    Parameters
    ----------
    galaxies
        Map from the galaxies that were drawn to those of the realisation.
    noise
        Map from the noise that was drawn to that of the realisation.
    """

    galaxies: Callable[[Galaxies], Galaxies]
    noise: Callable[[FacetSimulator, FacetNoise], FacetNoise]


def _as_drawn(galaxies: Galaxies) -> Galaxies:
    return galaxies


def _crossed(galaxies: Galaxies) -> Galaxies:
    return replace(galaxies, ellipticity=-galaxies.ellipticity)


def _turned(galaxies: Galaxies) -> Galaxies:
    return replace(galaxies, l=-galaxies.m, m=galaxies.l, ellipticity=-galaxies.ellipticity)


def _same(simulator: FacetSimulator, noise: FacetNoise) -> FacetNoise:
    del simulator
    return noise


def _negative(simulator: FacetSimulator, noise: FacetNoise) -> FacetNoise:
    del simulator
    return -noise


OPPOSITE: Final = tuple(
    Realisation(shape, noise) for shape in (_as_drawn, _crossed) for noise in (_same, _negative)
)
"""Ellipticities of both signs with noise of both signs: all terms that are odd in either cancel."""


def _turn(realisation: Realisation) -> Realisation:
    return Realisation(
        lambda galaxies: _turned(realisation.galaxies(galaxies)),
        lambda simulator, noise: simulator.turned(realisation.noise(simulator, noise)),
    )


TURNED: Final = (*OPPOSITE, *(_turn(realisation) for realisation in OPPOSITE))
"""The realisations of ``OPPOSITE``, and the same turned by a right angle together with their noise.

Without a shear only the effect of the direction of the beam remains in the average: one galaxy determines the additive
bias as well as a hundred galaxies with the realisations of ``OPPOSITE`` alone."""
