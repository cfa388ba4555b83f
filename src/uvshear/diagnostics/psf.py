"""The point spread function of an observation at its phase centre."""

from dataclasses import dataclass

import numpy as np

from uvshear.errors import InputError
from uvshear.execution import SERIAL, Executor
from uvshear.imaging import ImageGrid, dirty_image
from uvshear.interferometer.visibilities import Observation
from uvshear.interferometer.weighting import NO_WEIGHT
from uvshear.typing import Array, Float


def point_spread_function(
    observation: Observation, grid: ImageGrid, *, executor: Executor = SERIAL
) -> Float[Array, "l m"]:
    r"""Beam of an observation's weights, 1 at its centre.

    .. math:: P(l, m) = \sum_k w_k \cos 2\pi (u_k l + v_k m + w_k (n - 1)) / \sum_k w_k
    """
    image = np.zeros((grid.size, grid.size))
    total = 0.0
    for chunk in observation.chunks():
        weights = chunk.weights
        unit = np.ones(weights.shape, np.result_type(weights.dtype, np.complex64))
        image += dirty_image(chunk.uvw, chunk.frequency, unit, weights, grid, executor=executor)
        total += float(weights.sum(dtype=float))
    if not total > 0:
        raise InputError(NO_WEIGHT)
    return image / total


@dataclass(frozen=True)
class CoverageSample:
    """Baselines for a picture: all, or some spread over the observation.

    Parameters
    ----------
    uvw
        [m].
    frequency
        Channel centres met [Hz].
    rows
        How many there are in all.
    """

    uvw: Float[Array, "row 3"]
    frequency: Float[Array, " chan"]
    rows: int


def sample_coverage(observation: Observation, most: int = 1_000_000) -> CoverageSample:
    """Read the baselines that carry weight; where there are more than ``most``, some at random."""
    kept, keys = np.empty((0, 3)), np.empty(0)
    frequencies: set[float] = set()
    rows, part = 0, 1.0
    rng = np.random.default_rng(0)  # a regular stride would meet the same baselines again and again
    for chunk in observation.chunks():
        uvw = chunk.uvw[np.any(chunk.weights > 0, axis=1)]
        frequencies.update(chunk.frequency.tolist())
        rows += len(uvw)
        kept = np.concatenate([kept, uvw])
        keys = np.concatenate([keys, rng.uniform(size=len(uvw))])
        if len(kept) > most:
            part = min(part, most / rows)
            kept, keys = kept[keys < part], keys[keys < part]
    return CoverageSample(kept, np.array(sorted(frequencies)), rows)
