"""The point spread function of an observation at its phase centre."""

from typing import Self

import numpy as np

from uvshear.errors import InputError
from uvshear.execution import SERIAL, Executor
from uvshear.imaging import ImageGrid, dirty_image
from uvshear.interferometer.accumulate import Accumulator, accumulate
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.interferometer.weighting import NO_WEIGHT
from uvshear.typing import Array, Float


class PsfAccumulator(Accumulator[Float[Array, "l m"]]):
    r"""Beam of an observation's weights, 1 at its centre.

    .. math:: P(l, m) = \sum_k w_k \cos 2\pi (u_k l + v_k m + w_k (n - 1)) / \sum_k w_k

    Parameters
    ----------
    grid
        Pixels of the image.
    executor
        Its workers are the gridder's.
    """

    def __init__(self, grid: ImageGrid, executor: Executor = SERIAL) -> None:
        self._grid, self._executor = grid, executor
        self._image = np.zeros((grid.size, grid.size))
        self._total = 0.0

    def add(self, seen: Visibilities) -> None:
        """Image the weights of a chunk."""
        weights = seen.weights
        unit = np.ones(weights.shape, np.result_type(weights.dtype, np.complex64))
        self._image += dirty_image(
            seen.uvw, seen.frequency, unit, weights, self._grid, executor=self._executor
        )
        self._total += float(weights.sum(dtype=float))

    def merge(self, later: Self) -> None:
        """Add the image of later visibilities."""
        self._image += later._image
        self._total += later._total

    def result(self) -> Float[Array, "l m"]:
        """Return the beam."""
        if not self._total > 0:
            raise InputError(NO_WEIGHT)
        return self._image / self._total


def point_spread_function(
    observation: Observation, grid: ImageGrid, *, executor: Executor = SERIAL
) -> Float[Array, "l m"]:
    """Compute the PSF (dirty beam) of an observation in one pass over its visibilities (:class:`PsfAccumulator`)."""
    (image,) = accumulate(observation, [PsfAccumulator(grid, executor)])
    return image
