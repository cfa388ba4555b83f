"""Fourier sums over a square of pixels, cell by cell; and galaxies on uv cells, from their definition."""

import numpy as np


def facet(square, pixel, uv, multiplicity):
    """sum_x b(x) exp(+2 pi i k.x) / size^2, times how often the cell counts; the centre is pixel size/2.

    Without the first row and column, which have no opposite.
    """
    size = len(square)
    x = (np.arange(size) - size // 2) * pixel
    paired = np.array(square, float)
    paired[0, :] = paired[:, 0] = 0
    sums = [np.exp(2j * np.pi * u * x) @ paired @ np.exp(2j * np.pi * v * x) for u, v in uv]
    return np.array(sums) * multiplicity / size**2


def galaxy(uv, flux, offset, e, alpha, kind="exponential"):
    """S f(4 pi^2 alpha^2 |A^-T k|^2) exp(2 pi i k.x)."""
    inverse = np.linalg.inv([[1 - e.real, -e.imag], [-e.imag, 1 + e.real]])
    q = (2 * np.pi * alpha) ** 2 * np.sum((inverse.T @ uv.T) ** 2, axis=0)
    envelope = {"exponential": (1 + q) ** -1.5, "gaussian": np.exp(-q / 2)}[kind]
    return flux * envelope * np.exp(2j * np.pi * uv @ np.asarray(offset))
