"""An order of samples in which the gridder is fast: samples that are near one another in the uv plane come together.

The gridder sorts the samples by the part of the uv plane in which they lie, and then reads the baselines and the data
from all over the memory. Where samples are in this order already, what it reads next is mostly in a cache.
"""

import numpy as np

from uvshear.execution import Executor
from uvshear.imaging import kernels
from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Float, Int

SIDE = 128
"""Number of squares along each axis, within each of which the order of samples stays. Finer squares gain nothing."""


def uv_order(uvw: Float[Array, "sample 3"]) -> Int[Array, " sample"]:
    """Return the numbers of the samples, square after square of the uv plane.

    With 4 million samples on an image of 762 pixels the gridder takes 0.3 to 0.35 of the time that it takes in a random
    order, and the order itself takes a tenth of what is gained.

    Parameters
    ----------
    uvw
        Baselines, in any unit.
    """
    square = np.empty(len(uvw), np.uint16)
    longest = float(np.abs(uvw[:, :2]).max(initial=0.0))
    kernels.number_squares(uvw, SIDE / 2 / longest if longest > 0 else 0.0, SIDE, square)
    # For integers of 16 bits this is a radix sort.
    return np.argsort(square, kind="stable")


def in_uv_order(samples: Samples, executor: Executor) -> Samples:
    """Return the samples in this order."""
    return samples.taken(uv_order(samples.uvw), executor)
