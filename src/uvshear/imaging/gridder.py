"""Fourier transforms between visibilities and images: the only module that knows the signs of ducc0's gridder.

Everywhere else a source at (l, m) has visibilities exp(+2 pi i [u l + v m + w (n - 1)]). The gridder's kernel is
exp(+2 pi i [u x + v y - w (n - 1)]) in its images, so that the signs of u and v turn it into ours.
"""

from typing import Any

import ducc0
import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.imaging.grid import ImageGrid
from uvshear.typing import Array, Bool, Complex, Float

_OUR_SIGNS = {"flip_u": True, "flip_v": True}

POINT_EPSILON = 1e-7
"""Relative error of :func:`visibilities_at`."""


def grid(
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    vis: Complex[Array, "row chan"],
    image: ImageGrid,
    *,
    epsilon: float,
    with_w: bool,
    weights: Float[Array, "row chan"] | None = None,
    mask: Bool[Array, "row chan"] | None = None,
    executor: Executor = SERIAL,
) -> Float[Array, "l m"]:
    r"""Image of visibilities, a sum and not a mean.

    .. math:: b(l, m) = \sum_k w_k \mathrm{Re}[d_k e^{-2\pi i (u_k l + v_k m + w_k (n - 1))}]

    Parameters
    ----------
    uvw
        Baselines [m].
    frequency
        Channel centres, in rising order [Hz].
    vis, weights
        d and w, in one precision; weights are 1 unless given.
    image
        Pixels of the image.
    epsilon
        Relative error in the root mean square, at least 1e-6 for single precision.
    with_w
        Whether the term w (n - 1) is included.
    mask
        Visibilities that are used; all unless given.
    executor
        Its number of workers is the gridder's number of threads.
    """
    return ducc0.wgridder.vis2dirty(
        uvw=uvw,
        freq=frequency,
        vis=vis,
        wgt=weights,
        mask=None if mask is None else mask.astype(np.uint8),
        npix_x=image.size,
        npix_y=image.size,
        **_shared(image, epsilon, with_w=with_w, executor=executor),
    )


def degrid(
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    pixels: Float[Array, "l m"],
    image: ImageGrid,
    *,
    epsilon: float,
    with_w: bool,
    executor: Executor = SERIAL,
) -> Complex[Array, "row chan"]:
    r"""Visibilities of an image, the adjoint of :func:`grid`.

    .. math:: d_k = \sum_{l, m} b(l, m)\, e^{2\pi i (u_k l + v_k m + w_k (n - 1))}

    Parameters
    ----------
    uvw
        Baselines [m].
    frequency
        Channel centres, in rising order [Hz].
    pixels
        Values b of the pixels of ``image``.
    epsilon
        Relative error in the root mean square, at least 1e-6 for single precision.
    with_w
        Whether the term w (n - 1) is included.
    executor
        Its number of workers is the gridder's number of threads.
    """
    return ducc0.wgridder.dirty2vis(
        uvw=uvw,
        freq=frequency,
        dirty=pixels,
        **_shared(image, epsilon, with_w=with_w, executor=executor),
    )


def visibilities_at(
    image: Complex[Array, "l m"], pixel: float, uv: Float[Array, "point 2"]
) -> Complex[Array, " point"]:
    """Sum of a complex image over its pixels with exp(+2 pi i (u l + v m)), at any points of the uv plane.

    Parameters
    ----------
    image
        Values of the pixels; the origin of l and m is pixel (n // 2, n // 2).
    pixel
        Width of a pixel [rad].
    uv
        Points at which the transform is evaluated [wavelengths].
    """
    return np.asarray(
        ducc0.nufft.u2nu(
            grid=image, coord=uv * pixel, forward=False, epsilon=POINT_EPSILON, periodicity=1.0
        )
    )


def _shared(
    image: ImageGrid, epsilon: float, *, with_w: bool, executor: Executor
) -> dict[str, Any]:
    """Arguments that gridding and degridding have in common."""
    return _OUR_SIGNS | {
        "pixsize_x": image.pixel,
        "pixsize_y": image.pixel,
        "center_x": -image.l0,  # the flips of u and v apply to the centre too
        "center_y": -image.m0,
        "epsilon": epsilon,
        "do_wgridding": with_w,
        "divide_by_n": False,
        "nthreads": executor.workers,
    }
