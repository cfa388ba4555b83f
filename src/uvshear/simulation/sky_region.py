"""The region of the sky in which simulated galaxies are placed."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from uvshear.typing import Array, Float


class SkyRegion(ABC):
    """A region of the (l, m) plane about the phase centre, filled uniformly."""

    @property
    @abstractmethod
    def area(self) -> float:
        """Area in the (l, m) plane [sr]; the solid angle is larger by 1/n, 4e-5 for a square degree."""

    @abstractmethod
    def draw(
        self, number: int, rng: np.random.Generator
    ) -> tuple[Float[Array, " source"], Float[Array, " source"]]:
        """Draw directions (l, m)."""


@dataclass(frozen=True)
class SquareField(SkyRegion):
    """Square with sides of this length [rad] along l and m."""

    side: float

    @property
    def area(self) -> float:
        """Side squared."""
        return self.side**2

    def draw(
        self, number: int, rng: np.random.Generator
    ) -> tuple[Float[Array, " source"], Float[Array, " source"]]:
        """Draw directions (l, m)."""
        l, m = rng.uniform(-self.side / 2, self.side / 2, (2, number))
        return l, m


@dataclass(frozen=True)
class DiscField(SkyRegion):
    """Disc of this radius [rad]."""

    radius: float

    @property
    def area(self) -> float:
        """Pi radius squared."""
        return math.pi * self.radius**2

    def draw(
        self, number: int, rng: np.random.Generator
    ) -> tuple[Float[Array, " source"], Float[Array, " source"]]:
        """Draw directions (l, m)."""
        r = self.radius * np.sqrt(rng.uniform(size=number))
        angle = rng.uniform(0, 2 * np.pi, number)
        return r * np.cos(angle), r * np.sin(angle)
