"""Dirty image of a set of visibilities."""

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.imaging.grid import ImageGrid
from uvshear.imaging.gridder import grid as grid_visibilities
from uvshear.typing import Array, Bool, Complex, Float


def dirty_image(
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    vis: Complex[Array, "row chan"],
    weights: Float[Array, "row chan"],
    grid: ImageGrid,
    *,
    with_w: bool = True,
    mask: Bool[Array, "row chan"] | None = None,
    epsilon: float = 1e-5,
    executor: Executor = SERIAL,
) -> Float[Array, "l m"]:
    r"""Natural-weight dirty image, not divided by the sum of weights [Jy^-1 for visibilities in Jy].

    .. math:: b(l, m) = \sum_k w_k \mathrm{Re}[d_k e^{-2\pi i (u_k l + v_k m + w_k (n - 1))}]

    Parameters
    ----------
    uvw
        Baselines [m].
    frequency
        Channel centres, in rising or falling order [Hz].
    vis, weights
        Visibilities d and their weights w.
    grid
        Pixels of the image.
    with_w
        Whether the term w (n - 1) is included.
    mask
        Visibilities that are used; all unless given.
    epsilon
        Relative error in the root mean square. The image has single precision for complex64 visibilities
        (``epsilon`` >= 1e-5), double precision otherwise.
    executor
        Its number of workers is the gridder's number of threads.
    """
    # The gridder takes rising frequencies only; those of a lower sideband fall.
    if len(frequency) > 1 and frequency[0] > frequency[-1]:
        frequency, vis, weights = frequency[::-1], vis[:, ::-1], weights[:, ::-1]
        mask = None if mask is None else mask[:, ::-1]
    return grid_visibilities(
        np.asarray(uvw, float),
        frequency,
        vis,
        grid,
        epsilon=epsilon,
        with_w=with_w,
        weights=weights.astype(vis.real.dtype, copy=False),
        # A baseline outside the mask still counts in the gridder's choice of w-planes.
        mask=mask,
        executor=executor,
    )
