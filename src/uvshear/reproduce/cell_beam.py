"""The paper's facets of isolated galaxies: averages in a number of cells that is given, with any weighting."""

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from uvshear.bias.cell_average import PointingSamples
from uvshear.bias.mock_facets import FacetBeam, FacetNoise, FacetSimulator
from uvshear.extraction.paper.facets import INFORMATIVE
from uvshear.galaxy import Profile
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import Facet
from uvshear.reproduce.cell_counts import CellCount
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template
from uvshear.typing import Array, Float, Int

LADDER = 1.05
"""Ratio of successive scale lengths, by which the baselines without information are chosen."""


@dataclass(frozen=True)
class GriddedSimulator(FacetSimulator):
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
class CellBeam(FacetBeam):
    """All samples of an observation in the order of their baselines, for the paper's facets.

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
    _simulators: dict[tuple[int, int], GriddedSimulator] = field(default_factory=dict)

    @cached_property
    def _length(self) -> Float[Array, " sample"]:
        return np.hypot(*self.uv.T)

    @cached_property
    def _weighted(self) -> Float[Array, " sample"]:
        return self.natural * self.factors * self.scale

    @cached_property
    def _noise(self) -> Float[Array, " sample"]:
        return self.natural * (self.factors * self.scale) ** 2

    def simulator(self, log_median: float, sigma: float) -> GriddedSimulator:
        """Return the simulator for galaxies whose ln(scale length / rad) has this mean, whatever its deviation."""
        del sigma
        count = self.rule.cells(math.exp(log_median))
        rung = math.floor(log_median / math.log(LADDER))
        if (count, rung) not in self._simulators:
            self._simulators[count, rung] = self._with_cells(count // 2, LADDER**rung)
        return self._simulators[count, rung]

    def _with_cells(self, half: int, scale_length: float) -> GriddedSimulator:
        longest = float(self._length[-1])
        cell = longest * (1 + 1e-9) / half
        used = int(np.searchsorted(self._length, INFORMATIVE / scale_length, side="right"))
        nothing = np.zeros(used, np.complex64)
        samples = PointingSamples(self.uv[:used], self._weighted[:used])
        _, power = samples.sums(nothing, cell, half)
        _, noise = PointingSamples(self.uv[:used], self._noise[:used]).sums(nothing, cell, half)
        i, j = np.nonzero(power)
        cells = Cutout(2 * half, 1 / (2 * half * cell), 0.0, longest)
        return GriddedSimulator(cells, power[i, j], samples, cell, (i, j), noise[i, j])
