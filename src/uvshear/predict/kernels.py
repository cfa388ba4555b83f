"""Numba kernels of the prediction, for one source and one slab of samples or stamp; ``uvw`` is (3, row)."""

import math

from uvshear.compilation import compiled
from uvshear.geometry.kernels import sine_cosine_of_turns


@compiled
def profile_argument(uvw, per_metre, slope_l, slope_m, form, q):  # type: ignore[no-untyped-def]
    """Write 4 pi^2 alpha^2 |A^-T k|^2 into q, with k = (u - w l/n, v - w m/n) in wavelengths."""
    scale = 4 * math.pi**2 * per_metre**2
    a, b, c = form[0] * scale, form[1] * scale, form[2] * scale
    for i in range(q.size):
        u = uvw[0, i] - uvw[2, i] * slope_l
        v = uvw[1, i] - uvw[2, i] * slope_m
        q[i] = a * u * u + b * u * v + c * v * v


@compiled
def add_source(uvw, per_metre, lmn1, flux, envelope, real, imaginary):  # type: ignore[no-untyped-def]
    """Add flux x envelope x exp(2 pi i (u l + v m + w (n-1)))."""
    l, m, n1 = lmn1[0] * per_metre, lmn1[1] * per_metre, lmn1[2] * per_metre
    for i in range(real.size):
        sine, cosine = sine_cosine_of_turns(uvw[0, i] * l + uvw[1, i] * m + uvw[2, i] * n1)
        real[i] += flux * envelope[i] * cosine
        imaginary[i] += flux * envelope[i] * sine


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
