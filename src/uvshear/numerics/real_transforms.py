"""Fourier transforms of real images, by ducc0: in single precision they take two thirds of SciPy's time."""

import ducc0
import numpy as np

from uvshear.typing import Array, Complex, Float

_AXES = (0, 1)


def half_spectrum(image: Float[Array, "l m"]) -> Complex[Array, "u v"]:
    """Transform a real image, as ``rfft2`` does, in the calling thread."""
    return np.asarray(ducc0.fft.r2c(image, axes=_AXES, nthreads=1))


def images_of(spectra: Complex[Array, "image u v"], size: int) -> Float[Array, "image l m"]:
    """Transform back to square images of ``size`` pixels, as ``irfft2`` does, in the calling thread."""
    return np.asarray(
        ducc0.fft.c2r(spectra, axes=(1, 2), lastsize=size, forward=False, inorm=2, nthreads=1)
    )


def image_into(spectrum: Complex[Array, "u v"], image: Float[Array, "l m"]) -> None:
    """Write the transform of a spectrum into a square image, whose first pixel is its origin, as ``irfft2`` does."""
    size = image.shape[1]
    ducc0.fft.c2r(
        spectrum, axes=_AXES, lastsize=size, forward=False, inorm=2, nthreads=1, out=image
    )
