"""Numba kernels of the prediction, for a few sources and one slab of samples or for one stamp; ``uvw`` is (3, row)."""

import math

import numpy as np

from uvshear.compilation import compiled
from uvshear.geometry.kernels import sine_cosine_of_turns, sine_cosine_of_turns_single

ROWS = 512
"""Number of rows whose baselines and sums fit into the level-1 cache."""


@compiled
def profile_arguments(uvw, per_metre, slopes, forms, q):  # type: ignore[no-untyped-def]
    """Write 4 pi^2 alpha^2 |A^-T k|^2 of each source into q (source, row), with k = (u - w l/n, v - w m/n).

    k is in wavelengths. The arithmetic is in the precision of q, in which ``uvw`` must be.
    """
    scale, precision = 4 * math.pi**2 * per_metre**2, q.dtype.type
    for s in range(len(q)):
        a, b, c = forms[s] * scale
        a, b, c = precision(a), precision(b), precision(c)
        x, y, own = precision(slopes[s, 0]), precision(slopes[s, 1]), q[s]
        for i in range(own.size):
            u = uvw[0, i] - uvw[2, i] * x
            v = uvw[1, i] - uvw[2, i] * y
            own[i] = a * u * u + b * u * v + c * v * v


@compiled
def add_sources(uvw, per_metre, lmn1, flux, envelope, real, imaginary):  # type: ignore[no-untyped-def]
    """Add flux x envelope x exp(2 pi i (u l + v m + w (n-1))) of each source."""
    for start in range(0, real.size, ROWS):
        rows = slice(start, start + ROWS)
        u, v, w = uvw[0, rows], uvw[1, rows], uvw[2, rows]
        x, y = real[rows], imaginary[rows]
        for s in range(len(flux)):
            l, m, n1 = lmn1[s, 0] * per_metre, lmn1[s, 1] * per_metre, lmn1[s, 2] * per_metre
            scale, own = flux[s], envelope[s, rows]
            for i in range(x.size):
                sine, cosine = sine_cosine_of_turns(u[i] * l + v[i] * m + w[i] * n1)
                amplitude = scale * own[i]
                x[i] += amplitude * cosine
                y[i] += amplitude * sine


@compiled
def add_sources_single(uvw, per_metre, lmn1, flux, envelope, real, imaginary):  # type: ignore[no-untyped-def]
    """Do the same as :func:`add_sources` in single precision, but for the turns and the sums."""
    for start in range(0, real.size, ROWS):
        rows = slice(start, start + ROWS)
        u, v, w = uvw[0, rows], uvw[1, rows], uvw[2, rows]
        x, y = real[rows], imaginary[rows]
        for s in range(len(flux)):
            l, m, n1 = lmn1[s, 0] * per_metre, lmn1[s, 1] * per_metre, lmn1[s, 2] * per_metre
            scale, own = np.float32(flux[s]), envelope[s, rows]
            for i in range(x.size):
                sine, cosine = sine_cosine_of_turns_single(u[i] * l + v[i] * m + w[i] * n1)
                amplitude = scale * own[i]
                x[i] += amplitude * cosine
                y[i] += amplitude * sine


@compiled
def plane_argument(u, v, form, q):  # type: ignore[no-untyped-def]
    """Write form[0] u^2 + form[1] u v + form[2] v^2 on a plane of cells into q."""
    a, b, c = form
    for i in range(u.size):
        first, second = a * u[i] * u[i], b * u[i]
        for j in range(v.size):
            q[i, j] = first + (second + c * v[j]) * v[j]


@compiled
def plane_spectrum(envelope, taper, along_u, along_v, spectrum):  # type: ignore[no-untyped-def]
    """Write the product of envelope, taper, and the phases of both axes."""
    for i in range(along_u.size):
        for j in range(along_v.size):
            spectrum[i, j] = (envelope[i, j] * taper[i, j]) * (along_u[i] * along_v[j])
