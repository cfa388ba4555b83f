"""Visibilities to dirty image: the only caller of the gridder, and the only place that knows its signs."""

import ducc0
import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.imaging.grid import ImageGrid
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

    Relative error ``epsilon`` in the root mean square. Single precision for complex64 visibilities
    (``epsilon`` >= 1e-5), double otherwise.
    """
    if (
        len(frequency) > 1 and frequency[0] > frequency[-1]
    ):  # a lower sideband; the gridder wants it rising
        frequency, vis, weights = frequency[::-1], vis[:, ::-1], weights[:, ::-1]
        mask = None if mask is None else mask[:, ::-1]
    # The gridder's kernel is exp(+2 pi i [u x + v y - w (n-1)]): the signs of u and v turn it into ours.
    # A baseline out of the mask still counts in the gridder's choice of w-planes, hence the selection.
    return ducc0.wgridder.vis2dirty(
        uvw=np.asarray(uvw, float) * (-1.0, -1.0, 1.0),
        freq=frequency,
        vis=vis,
        wgt=weights.astype(vis.real.dtype, copy=False),
        mask=None if mask is None else mask.astype(np.uint8),
        npix_x=grid.size,
        npix_y=grid.size,
        pixsize_x=grid.pixel,
        pixsize_y=grid.pixel,
        center_x=grid.l0,
        center_y=grid.m0,
        epsilon=epsilon,
        do_wgridding=with_w,
        divide_by_n=False,
        nthreads=executor.workers,
    )
