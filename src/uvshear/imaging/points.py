"""Visibilities of an image at any points of the uv plane."""

import ducc0
import numpy as np

from uvshear.typing import Array, Complex, Float

EPSILON = 1e-7


def visibilities_at(
    image: Complex[Array, "l m"], pixel: float, uv: Float[Array, "point 2"]
) -> Complex[Array, " point"]:
    """Sum an image over its pixels with exp(+2 pi i (u l + v m)).

    Parameters
    ----------
    image
        Its centre is pixel (n // 2, n // 2).
    pixel
        Width [rad].
    uv
        [wavelengths].
    """
    return np.asarray(
        ducc0.nufft.u2nu(
            grid=image, coord=uv * pixel, forward=False, epsilon=EPSILON, periodicity=1.0
        )
    )
