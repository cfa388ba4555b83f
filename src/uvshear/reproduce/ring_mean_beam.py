"""A beam whose power is replaced by its means over rings of the uv plane: an experiment, which no array can give."""

from dataclasses import dataclass, field

import numpy as np

from uvshear.bias.mock_facets import FacetBeam, FacetSimulator
from uvshear.imaging.cutout import Cutout
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class RingMeanBeam(FacetBeam):
    """The round beam that has as much power in each ring of the uv plane as another beam.

    Parameters
    ----------
    beam
        The other beam.
    """

    beam: FacetBeam
    _simulators: dict[int, FacetSimulator] = field(default_factory=dict)

    def simulator(self, log_median: float, sigma: float) -> FacetSimulator:
        """Return the simulator for galaxies whose ln(scale length / rad) has this mean and standard deviation."""
        known = self.beam.simulator(log_median, sigma)
        if id(known) not in self._simulators:
            power = ring_means_of_cells(known.cutout, known.power)
            self._simulators[id(known)] = FacetSimulator(known.cutout, power)
        return self._simulators[id(known)]


def ring_means_of_cells(cells: Cutout, power: Float[Array, " cell"]) -> Float[Array, " cell"]:
    """Return for each cell the mean power of the cells in its ring, which is as wide as a cell."""
    ring = np.rint(np.hypot(*cells.uv.T) * cells.size * cells.pixel).astype(int)
    total, count = np.bincount(ring, power), np.bincount(ring)
    means: Float[Array, " cell"] = (total / np.maximum(count, 1))[ring]
    return means
