"""Numba kernels of the direct sum, over one slab of samples and one source at a time; ``uvw`` is (3, row)."""

import math

import numpy as np

from uvshear.compilation import compiled, inlined

# Taylor series of sin and cos about 0, good to 4e-14 on [-pi/2, pi/2]; libm's would not vectorise.
_S3, _S5, _S7, _S9, _S11, _S13, _S15, _S17 = (
    (-1) ** k / math.factorial(2 * k + 1) for k in range(1, 9)
)


@inlined
def sine_cosine_of_turns(turns):  # type: ignore[no-untyped-def]
    """Sine and cosine of 2 pi turns to 1e-13, without a branch, so that loops around it vectorise."""
    # The reduction to one turn comes first and in float64: |turns| reaches 1e4.
    half = math.pi * (turns - np.rint(turns))
    z = half * half
    s = half * (
        1
        + z
        * (
            _S3
            + z * (_S5 + z * (_S7 + z * (_S9 + z * (_S11 + z * (_S13 + z * (_S15 + z * _S17))))))
        )
    )
    c = _cosine(z)
    return 2 * s * c, 1 - 2 * s * s


_C2, _C4, _C6, _C8, _C10, _C12, _C14, _C16, _C18 = (
    (-1) ** k / math.factorial(2 * k) for k in range(1, 10)
)


@inlined
def _cosine(z):  # type: ignore[no-untyped-def]
    return 1 + z * (
        _C2
        + z
        * (
            _C4
            + z * (_C6 + z * (_C8 + z * (_C10 + z * (_C12 + z * (_C14 + z * (_C16 + z * _C18))))))
        )
    )


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
def rotate_phase(uvw, per_metre, lmn1, vis, rotated):  # type: ignore[no-untyped-def]
    """Multiply by exp(-2 pi i (u l + v m + w (n-1))): the phase centre moves to (l, m)."""
    l, m, n1 = lmn1[0] * per_metre, lmn1[1] * per_metre, lmn1[2] * per_metre
    for i in range(vis.size):
        sine, cosine = sine_cosine_of_turns(uvw[0, i] * l + uvw[1, i] * m + uvw[2, i] * n1)
        real, imaginary = vis[i].real, vis[i].imag
        rotated[i] = complex(real * cosine + imaginary * sine, imaginary * cosine - real * sine)
