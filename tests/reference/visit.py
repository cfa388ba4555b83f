"""Residual facet and beam of one source by direct sums over visibilities and pixels."""

import numpy as np

from tests.reference import dirty, plane

SPEED_OF_LIGHT = 299_792_458.0


def _within(uvw, frequency, weights, shortest, longest):
    distance = np.hypot(uvw[:, 0], uvw[:, 1])[:, None] * frequency / SPEED_OF_LIGHT
    return np.where((distance >= shortest) & (distance < longest), weights, 0.0)


def _lattice(centre, size, pixel):
    x = (np.arange(size) - size // 2) * pixel
    return np.meshgrid(centre[0] + x, centre[1] + x, indexing="ij")


def residual_facet(seen, vis, gain, cutout, place, offset, uv_range):
    """Dirty image on the square of pixels about ``place`` [rad], its Fourier sum, the centre moved by ``offset``.

    ``seen`` holds uvw [m], frequency and weights; ``gain`` is the matched filter of each channel.
    """
    weights = _within(seen.uvw, seen.frequency, seen.weights, *uv_range) * gain
    l, m = _lattice(place, cutout.size, cutout.pixel)
    square = dirty.dirty_image(seen.uvw, seen.frequency, vis, weights, l, m)
    sums = plane.facet(square, cutout.pixel, cutout.uv, cutout.multiplicity)
    return sums * np.exp(-2j * np.pi * cutout.uv @ np.asarray(offset))


def beam_square(seen, gain, size, pixel, direction, uv_range):
    """Dirty beam about a direction, its own first order of w (n - 1) in it, higher ones left out."""
    l, m = direction
    n = np.sqrt(1 - l**2 - m**2)
    u, v, w = seen.uvw.T
    weights = _within(seen.uvw, seen.frequency, seen.weights, *uv_range) * gain**2
    flat = np.column_stack([u - w * l / n, v - w * m / n, np.zeros(len(w))])
    return dirty.beam(flat, seen.frequency, weights, *_lattice((0.0, 0.0), size, pixel))
