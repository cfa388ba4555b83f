"""Natural-weight dirty image and beam by the direct sum over visibilities."""

import numpy as np

SPEED_OF_LIGHT = 299_792_458.0


def dirty_image(uvw, frequency, vis, weights, l, m):
    """b(l, m) = sum_k w_k Re[d_k exp(-2 pi i (u l + v m + w (n-1)))] at every direction (l, m)."""
    n_minus_one = np.sqrt(1 - l**2 - m**2) - 1
    image = np.zeros(np.shape(l))
    for chan, nu in enumerate(frequency):
        for row, (u, v, w) in enumerate(uvw * nu / SPEED_OF_LIGHT):
            turns = u * l + v * m + w * n_minus_one
            image += weights[row, chan] * np.real(vis[row, chan] * np.exp(-2j * np.pi * turns))
    return image


def beam(uvw, frequency, weights, l, m):
    """Return the dirty image of a unit point source at the phase centre."""
    return dirty_image(uvw, frequency, np.ones(weights.shape, complex), weights, l, m)


def inner(weights, a, b):
    """<a, b> = sum_k w_k Re(a_k* b_k)."""
    return float(np.sum(weights * np.real(np.conj(a) * b)))
