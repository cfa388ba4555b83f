"""Facets of isolated galaxies, drawn without visibilities.

The correlation of a facet is the power of the beam times the model, plus noise whose variance in each component is that
power. The sum over visibilities would have the same distribution.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from typing import Self

import numpy as np
from scipy.spatial import KDTree

from uvshear.execution import SERIAL, Executor
from uvshear.extraction.converged.beams import BeamPlan, gather_beams, power_of
from uvshear.extraction.converged.plan import LADDER, SMALL
from uvshear.galaxy import Galaxies, Profile
from uvshear.imaging.bands import OVERSAMPLING
from uvshear.imaging.cutout import Cutout, cutout, cutout_size
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.gridded import Gridding
from uvshear.predict.response import Response
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.template import Template
from uvshear.typing import Array, Bool, Complex, Float, Int

SCALE_LENGTHS = 45.0
"""Width of a facet over the median scale length, as in the extraction."""

WIDEST = 560
"""Largest side of a facet [pixels], which the image of the beam must cover."""

FacetNoise = Complex[Array, " cell"]
"""Noise of a facet's cells, in standard deviations of each component."""


@dataclass(frozen=True)
class FacetSimulator:
    """Draws facets of galaxies on given cells.

    Parameters
    ----------
    cutout
        The square of pixels that the cells belong to.
    power
        Power of the beam on the cells [Jy^-2].
    """

    cutout: Cutout
    power: Float[Array, " cell"]

    @property
    def uv(self) -> Float[Array, "cell 2"]:
        """Centres of the cells [wavelengths]."""
        return self.cutout.uv

    def draw_noise(self, rng: np.random.Generator) -> FacetNoise:
        """Draw noise of unit variance in each component of every cell."""
        first, second = rng.standard_normal((2, len(self.power)))
        return first + 1j * second

    def turned(self, noise: FacetNoise) -> FacetNoise:
        """Return the noise of a sky that is turned by a right angle from l towards m."""
        cell, is_opposite = self._quarter_turn
        return np.where(is_opposite, noise[cell].conj(), noise[cell])

    @cached_property
    def _quarter_turn(self) -> tuple[Int[Array, " cell"], Bool[Array, " cell"]]:
        """For each cell, the cell that a quarter turn takes there, and whether that is in the other half plane."""
        u, v = self.uv.T
        before = np.column_stack([v, -u])
        tree = KDTree(np.concatenate([self.uv, -self.uv]))
        distance, found = tree.query(before)
        spacing = 1 / (self.cutout.size * self.cutout.pixel)
        if distance.max() > 1e-3 * spacing:
            raise ValueError("the cells are not the same after a quarter turn")
        return found % len(u), found >= len(u)

    def facet(self, galaxy: GalaxyFit, profile: Profile, noise: FacetNoise) -> Facet:
        """Return the facet of a galaxy with noise, as the sum over its visibilities would be."""
        model = Template(self.uv, profile).model(galaxy)
        correlation = self.power * model + np.sqrt(self.power) * noise
        return Facet(self.uv, correlation, self.power)

    def snr_of_jansky(self, prior: ShapePrior, profile: Profile) -> float:
        """Return the signal-to-noise ratio of a round galaxy of one jansky and of the prior's median size."""
        galaxy = GalaxyFit(1.0, np.zeros(2), 0j, math.exp(prior.log_scale_length), 0.0)
        model = Template(self.uv, profile).model(galaxy)
        return math.sqrt(float(np.sum(self.power * np.abs(model) ** 2)))


class FacetBeam(ABC):
    """Beam of an observation towards its phase centre, from which the facets of galaxies of any size are drawn."""

    @abstractmethod
    def simulator(self, log_median: float, sigma: float) -> FacetSimulator:
        """Return the simulator for galaxies whose ln(scale length / rad) has this mean and standard deviation."""


@dataclass(frozen=True)
class MockBeam(FacetBeam):
    """Dirty beam of an observation towards its phase centre, for facets of any size.

    Parameters
    ----------
    image
        Image of the beam [Jy^-2].
    pixel
        Side of a pixel of the image [rad].
    longest
        Longest baseline in the image [wavelengths].
    """

    image: Float[Array, "l m"]
    pixel: float
    longest: float
    _simulators: dict[Cutout, FacetSimulator] = field(default_factory=dict)

    @classmethod
    def gather(
        cls,
        observation: Observation,
        galaxies: Galaxies,
        smallest: float,
        executor: Executor = SERIAL,
    ) -> Self:
        """Gather the beam of an observation.

        Parameters
        ----------
        galaxies
            A galaxy of the population's spectral index; fluxes of facets are those of the catalogue.
        smallest
            Scale length of the smallest galaxies [rad].
        """
        longest = SMALL / smallest
        pixel = 1 / (2 * OVERSAMPLING * longest)
        gridding = Gridding(executor=executor)
        response = Response.from_sky(galaxies)
        plan = BeamPlan.around(galaxies, response, 0.0, longest, pixel)
        beams = gather_beams(observation, plan, response, gridding)
        return cls(beams.images[0], pixel, longest)

    def simulator(self, log_median: float, sigma: float) -> FacetSimulator:
        """Return the simulator for galaxies whose ln(scale length / rad) has this mean and standard deviation."""
        width = SCALE_LENGTHS * math.exp(log_median)
        step = math.ceil(math.log(width / self.pixel) / math.log(LADDER) - 1e-9)
        size = min(cutout_size(self.pixel * LADDER**step, self.pixel), WIDEST)
        reach = min(SMALL / math.exp(log_median - 2 * sigma), self.longest)
        rung = math.floor(math.log(self.longest / reach) / math.log(LADDER) + 1e-9)
        cells = cutout(size, self.pixel, 0.0, self.longest * LADDER**-rung)
        if cells not in self._simulators:
            power = np.maximum(power_of(self.image, cells), 0.0)
            self._simulators[cells] = FacetSimulator(cells, power)
        return self._simulators[cells]
