"""Which realisations of each simulated galaxy are measured."""

import cmath
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from uvshear.bias.mock_facets import FacetNoise, FacetSimulator
from uvshear.bias.realisations import OPPOSITE, TURNED, Realisation
from uvshear.galaxy import Galaxies


class Repeats(ABC):
    """A set of realisations."""

    @abstractmethod
    def realisations(self) -> Sequence[Realisation]:
        """Return the realisations."""


@dataclass(frozen=True)
class AsDrawn(Repeats):
    """The galaxy and its noise as they are drawn."""

    def realisations(self) -> Sequence[Realisation]:
        """Return one realisation."""
        return OPPOSITE[:1]


@dataclass(frozen=True)
class WithoutNoise(Repeats):
    """The galaxy as it is drawn, without noise."""

    def realisations(self) -> Sequence[Realisation]:
        """Return one realisation."""
        return (Realisation(OPPOSITE[0].galaxies, lambda _, noise: 0 * noise),)


@dataclass(frozen=True)
class OppositePairs(Repeats):
    """The ellipticities e and -e, each with noise and its negative."""

    def realisations(self) -> Sequence[Realisation]:
        """Return four realisations."""
        return OPPOSITE


@dataclass(frozen=True)
class TurnedPairs(Repeats):
    """Opposite pairs, and the same turned by a right angle: only the effect of the direction of the beam is left."""

    def realisations(self) -> Sequence[Realisation]:
        """Return eight realisations."""
        return TURNED


@dataclass(frozen=True)
class Ring(Repeats):
    """A ring of equally spaced ellipticities with one realisation of the noise each, as in the paper.

    The noise of the first is shuffled among the cells for the others, which are as good as independent.

    Parameters
    ----------
    number
        Number of galaxies in the ring.
    """

    number: int = 10

    def realisations(self) -> Sequence[Realisation]:
        """Return one realisation for each galaxy of the ring."""
        return tuple(_member(k, self.number) for k in range(self.number))


def _member(k: int, number: int) -> Realisation:
    turn = cmath.rect(1.0, 2 * math.pi * k / number)

    def galaxies(drawn: Galaxies) -> Galaxies:
        return replace(drawn, ellipticity=turn * drawn.ellipticity)

    def noise(simulator: FacetSimulator, drawn: FacetNoise) -> FacetNoise:
        del simulator
        return np.roll(drawn, k * (len(drawn) // number))

    return Realisation(galaxies, noise)
