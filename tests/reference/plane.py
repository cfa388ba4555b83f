"""Fourier sums over a square of pixels, cell by cell; and galaxies on uv cells, from their definition."""

import numpy as np


def taper(size):
    """1 up to 0.9 of the half width, then half a period of a cosine from 1 to 0; the centre is pixel size/2."""
    weights = []
    for pixel in range(size):
        x = abs(pixel - size // 2) / (size // 2)
        weights.append(1.0 if x <= 0.9 else (1 + np.cos(10 * np.pi * (x - 0.9))) / 2)
    return np.array(weights)


def facet(square, pixel, uv, multiplicity):
    """sum_x t(x) b(x) exp(+2 pi i k.x) / size^2, times how often the cell counts; the centre is pixel size/2."""
    size = len(square)
    x = (np.arange(size) - size // 2) * pixel
    along = taper(size)
    tapered = np.array(square, float) * np.outer(along, along)
    sums = [np.exp(2j * np.pi * u * x) @ tapered @ np.exp(2j * np.pi * v * x) for u, v in uv]
    return np.array(sums) * multiplicity / size**2


def galaxy(uv, flux, offset, e, alpha, kind="exponential"):
    """S f(4 pi^2 alpha^2 |A^-T k|^2) exp(2 pi i k.x)."""
    inverse = np.linalg.inv([[1 - e.real, -e.imag], [-e.imag, 1 + e.real]])
    q = (2 * np.pi * alpha) ** 2 * np.sum((inverse.T @ uv.T) ** 2, axis=0)
    envelope = {"exponential": (1 + q) ** -1.5, "gaussian": np.exp(-q / 2)}[kind]
    return flux * envelope * np.exp(2j * np.pi * uv @ np.asarray(offset))
