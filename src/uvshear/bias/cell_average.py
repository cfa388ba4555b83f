"""Isolated galaxies on the paper's cell-average facets, to reproduce the bias of Rivi & Miller 2018.

The visibilities of a galaxy are predicted one by one and averaged in cells; the noise is drawn for the sums in cells.
"""

import math
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from uvshear.bias.mock_facets import FacetBeam, FacetNoise, FacetSimulator
from uvshear.constants import REFERENCE_FREQUENCY, SPEED_OF_LIGHT
from uvshear.extraction.paper.cell_average import ScaleLengths
from uvshear.extraction.paper.facets import INFORMATIVE
from uvshear.extraction.paper.kernels import add_to_cells
from uvshear.galaxy import Profile
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import Observation
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template
from uvshear.typing import Array, Complex, Float, Int

LADDER = 1.05
"""Ratio of successive widths of facets."""

SMALLEST = 8
"""Smallest number of cells to either side of the origin."""


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

    Parameters
    ----------
    samples
        The samples that lie in the cells.
    cell
        Side of a cell [wavelengths].
    chosen
        Indices along u and v of the cells that hold samples.
    """

    samples: PointingSamples
    cell: float
    chosen: tuple[Int[Array, " cell"], Int[Array, " cell"]]

    @property
    def uv(self) -> Float[Array, "cell 2"]:
        """Centres of the cells [wavelengths]."""
        i, j = self.chosen
        return np.column_stack([i - self._half + 0.5, j + 0.5]) * self.cell

    @property
    def _half(self) -> int:
        return self.cutout.size // 2

    def facet(self, galaxy: GalaxyFit, profile: Profile, noise: FacetNoise) -> Facet:
        """Return the facet of the visibilities of a galaxy, with noise."""
        visibilities = Template(self.samples.uv, profile).model(galaxy)
        sums, _ = self.samples.sums(visibilities, self.cell, self._half)
        return Facet(self.uv, sums[self.chosen] + np.sqrt(self.power) * noise, self.power)


@dataclass(frozen=True)
class CellAverageBeam(FacetBeam):
    """All samples of an observation, for cell-average facets of any size.

    Parameters
    ----------
    samples
        Samples of the phase centre.
    longest
        Longest baseline [wavelengths].
    frequency
        Frequency of the longest baseline [Hz].
    rule
        Rule that gives the width of a galaxy's facet from its size.
    """

    samples: PointingSamples
    longest: float
    frequency: float
    rule: ScaleLengths = field(default_factory=ScaleLengths)
    _simulators: dict[int, CellAverageSimulator] = field(default_factory=dict)

    @classmethod
    def gather(cls, observation: Observation) -> Self:
        """Gather the samples of an observation, in which galaxies have the catalogue's flux in every channel."""
        uv, weight, highest = [], [], 0.0
        for chunk in observation.chunks():
            for channel, frequency in enumerate(chunk.frequency.tolist()):
                uv.append(chunk.uvw[:, :2] * (frequency / SPEED_OF_LIGHT))
                weight.append(chunk.weights[:, channel])
                highest = max(highest, frequency)
        samples = PointingSamples(np.concatenate(uv), np.concatenate(weight))
        return cls(samples, float(np.hypot(*samples.uv.T).max()), highest)

    def simulator(self, log_median: float, sigma: float) -> CellAverageSimulator:
        """Return the simulator for galaxies whose ln(scale length / rad) has this mean, whatever its deviation."""
        del sigma
        rung = math.ceil(log_median / math.log(LADDER))
        if rung not in self._simulators:
            self._simulators[rung] = self._of_size(LADDER**rung)
        return self._simulators[rung]

    def _of_size(self, scale_length: float) -> CellAverageSimulator:
        reference = self.longest * REFERENCE_FREQUENCY / self.frequency
        half = max(math.ceil(reference * self.rule.number * scale_length), SMALLEST)
        cell = self.longest * (1 + 1e-9) / half
        near = np.hypot(*self.samples.uv.T) <= INFORMATIVE / scale_length
        samples = PointingSamples(self.samples.uv[near], self.samples.weight[near])
        _, power = samples.sums(np.zeros(len(samples.uv), np.complex64), cell, half)
        i, j = np.nonzero(power)
        cells = Cutout(2 * half, 1 / (2 * half * cell), 0.0, self.longest)
        return CellAverageSimulator(cells, power[i, j], samples, cell, (i, j))
