"""Isolated galaxies on the paper's cell-average facets, to reproduce the bias of Rivi & Miller 2018.

The visibilities of a galaxy are predicted one by one and averaged in cells; the noise is drawn for the sums in cells.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from typing import Self

import numpy as np

from uvshear.bias.mock_facets import FacetBeam, FacetNoise, FacetSimulator
from uvshear.constants import REFERENCE_FREQUENCY, SPEED_OF_LIGHT
from uvshear.extraction.paper.cell_average import ScaleLengths
from uvshear.extraction.paper.facets import INFORMATIVE, spectral_gain
from uvshear.extraction.paper.kernels import add_to_cells
from uvshear.galaxy import Galaxies, Profile
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import Observation
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template
from uvshear.typing import Array, Complex, Float, Int

LADDER = 1.05
"""Ratio of successive scale lengths, by which the width of a facet and the baselines without information are chosen."""

SMALLEST = 8
"""Smallest number of cells to either side of the origin."""


class CellCount(ABC):
    """A rule for the number of cells along a side of a facet."""

    @abstractmethod
    def cells(self, scale_length: float) -> int:
        """Return the number of cells, which is even, for galaxies whose median scale length is this [rad]."""


@dataclass(frozen=True)
class ScaleLengthCount(CellCount):
    """Numbers of cells in proportion to the scale length, in steps.

    Parameters
    ----------
    longest
        Longest baseline at the reference frequency of fluxes [wavelengths].
    number
        Width of a facet, as in ``ScaleLengths``.
    """

    longest: float
    number: float = ScaleLengths().number

    def cells(self, scale_length: float) -> int:
        """Return the number of cells for the next larger step of scale lengths."""
        step = LADDER ** math.ceil(math.log(scale_length) / math.log(LADDER))
        return 2 * max(math.ceil(self.longest * self.number * step), SMALLEST)


@dataclass(frozen=True)
class PointingSamples:
    """Samples of one pointing without their visibilities.

    Parameters
    ----------
    uv
        Baselines [wavelengths].
    weight
        Weights [Jy^-2].
    """

    uv: Float[Array, "sample 2"]
    weight: Float[Array, " sample"]

    def sums(
        self, visibilities: Complex[Array, " sample"], cell: float, half: int
    ) -> tuple[Complex[Array, "u v"], Float[Array, "u v"]]:
        """Sum weighted visibilities, and weights, over cells of the uv plane.

        Parameters
        ----------
        cell
            Side of a cell [wavelengths].
        half
            Number of cells from the origin to the edge.
        """
        sums, power = np.zeros((2 * half, half), complex), np.zeros((2 * half, half))
        u, v = np.ascontiguousarray(self.uv.T)
        add_to_cells(u, v, visibilities, self.weight, 1.0, cell, sums, power)
        return sums, power


@dataclass(frozen=True)
class CellAverageSimulator(FacetSimulator):
    """Draws cell-average facets of galaxies.

    Noise is drawn for all cells of the half plane, also for those without samples, so that it can be turned.

    Parameters
    ----------
    samples
        The samples that lie in the cells, with the weights w T scale of the sums of visibilities.
    cell
        Side of a cell [wavelengths].
    chosen
        Indices along u and v of the cells that hold samples.
    noise_power
        Variance of each component of the weighted sums [Jy^-2].
    """

    samples: PointingSamples
    cell: float
    chosen: tuple[Int[Array, " cell"], Int[Array, " cell"]]
    noise_power: Float[Array, " cell"]

    @property
    def uv(self) -> Float[Array, "cell 2"]:
        """Centres of the cells [wavelengths]."""
        i, j = self.chosen
        return np.column_stack([i - self._half + 0.5, j + 0.5]) * self.cell

    @property
    def _half(self) -> int:
        return self.cutout.size // 2

    def draw_noise(self, rng: np.random.Generator) -> FacetNoise:
        """Draw noise of unit variance in each component of every cell of the half plane."""
        first, second = rng.standard_normal((2, 2 * self._half**2))
        return first + 1j * second

    def turned(self, noise: FacetNoise) -> FacetNoise:
        """Return the noise of a sky that is turned by a right angle from l towards m."""
        half = self._half
        square = noise.reshape(2 * half, half)
        i, j = np.meshgrid(np.arange(2 * half), np.arange(half), indexing="ij")
        # The value at (u, v) comes from (v, -u), or is the conjugate of that at (-v, u).
        is_here = i < half
        before = square[
            np.where(is_here, half + j, half - 1 - j), np.where(is_here, half - 1 - i, i - half)
        ]
        turned: FacetNoise = np.where(is_here, before, before.conj()).ravel()
        return turned

    def facet(self, galaxy: GalaxyFit, profile: Profile, noise: FacetNoise) -> Facet:
        """Return the facet of the visibilities of a galaxy, with noise."""
        visibilities = Template(self.samples.uv, profile).model(galaxy)
        sums, _ = self.samples.sums(visibilities, self.cell, self._half)
        i, j = self.chosen
        drawn = noise.reshape(2 * self._half, self._half)[i, j]
        return Facet(self.uv, sums[i, j] + np.sqrt(self.noise_power) * drawn, self.power)


@dataclass(frozen=True)
class CellAverageBeam(FacetBeam):
    """All samples of an observation in the order of their baselines, for cell-average facets of any size.

    Parameters
    ----------
    uv
        Baselines [wavelengths], the shortest first.
    natural
        Natural weights [Jy^-2].
    factors
        Factors T of the weighting.
    scale
        Number by which the weights are multiplied, so that the errors of a galaxy of median size are right.
    rule
        Rule for the number of cells.
    """

    uv: Float[Array, "sample 2"]
    natural: Float[Array, " sample"]
    factors: Float[Array, " sample"]
    scale: float
    rule: CellCount
    _simulators: dict[tuple[int, int], CellAverageSimulator] = field(default_factory=dict)

    @classmethod
    def gather(cls, observation: Observation, galaxies: Galaxies) -> Self:
        """Gather the samples of an observation, for facets with the width of ``ScaleLengths``.

        Parameters
        ----------
        galaxies
            A galaxy of the population's spectral index; fluxes of facets are those at its reference frequency.
        """
        uv, weight, highest = [], [], 0.0
        for chunk in observation.chunks():
            gains = spectral_gain(galaxies, chunk.frequency)
            for channel, frequency in enumerate(chunk.frequency.tolist()):
                uv.append(chunk.uvw[:, :2] * (frequency / SPEED_OF_LIGHT))
                weight.append(chunk.weights[:, channel] * gains[channel] ** 2)
                highest = max(highest, frequency)
        baselines, power = np.concatenate(uv), np.concatenate(weight).astype(float)
        longest = float(np.hypot(*baselines.T).max())
        rule = ScaleLengthCount(longest * REFERENCE_FREQUENCY / highest)
        return cls.from_samples(baselines, power, np.ones(len(power)), 1.0, rule)

    @classmethod
    def from_samples(
        cls,
        uv: Float[Array, "sample 2"],
        natural: Float[Array, " sample"],
        factors: Float[Array, " sample"],
        scale: float,
        rule: CellCount,
    ) -> Self:
        """Sort samples by the length of their baselines; the arguments are those of the class."""
        order = np.argsort(np.hypot(*uv.T))
        return cls(np.ascontiguousarray(uv[order]), natural[order], factors[order], scale, rule)

    @cached_property
    def _length(self) -> Float[Array, " sample"]:
        return np.hypot(*self.uv.T)

    @cached_property
    def _weighted(self) -> Float[Array, " sample"]:
        return self.natural * self.factors * self.scale

    @cached_property
    def _noise(self) -> Float[Array, " sample"]:
        return self.natural * (self.factors * self.scale) ** 2

    def simulator(self, log_median: float, sigma: float) -> CellAverageSimulator:
        """Return the simulator for galaxies whose ln(scale length / rad) has this mean, whatever its deviation."""
        del sigma
        count = self.rule.cells(math.exp(log_median))
        rung = math.floor(log_median / math.log(LADDER))
        if (count, rung) not in self._simulators:
            self._simulators[count, rung] = self._with_cells(count // 2, LADDER**rung)
        return self._simulators[count, rung]

    def _with_cells(self, half: int, scale_length: float) -> CellAverageSimulator:
        longest = float(self._length[-1])
        cell = longest * (1 + 1e-9) / half
        used = int(np.searchsorted(self._length, INFORMATIVE / scale_length, side="right"))
        nothing = np.zeros(used, np.complex64)
        samples = PointingSamples(self.uv[:used], self._weighted[:used])
        _, power = samples.sums(nothing, cell, half)
        _, noise = PointingSamples(self.uv[:used], self._noise[:used]).sums(nothing, cell, half)
        i, j = np.nonzero(power)
        cells = Cutout(2 * half, 1 / (2 * half * cell), 0.0, longest)
        return CellAverageSimulator(cells, power[i, j], samples, cell, (i, j), noise[i, j])
