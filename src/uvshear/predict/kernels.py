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
def add_rounded_sources(per_unit, uvw, per_metre, lmn1, flux, envelope, real, imaginary):  # type: ignore[no-untyped-def]
    """Do the same as :func:`add_sources`, with each source rounded to an integer number of units."""
    for start in range(0, real.size, ROWS):
        rows = slice(start, start + ROWS)
        u, v, w = uvw[0, rows], uvw[1, rows], uvw[2, rows]
        x, y = real[rows], imaginary[rows]
        for s in range(len(flux)):
            l, m, n1 = lmn1[s, 0] * per_metre, lmn1[s, 1] * per_metre, lmn1[s, 2] * per_metre
            scale, own = flux[s] * per_unit, envelope[s, rows]
            for i in range(x.size):
                sine, cosine = sine_cosine_of_turns(u[i] * l + v[i] * m + w[i] * n1)
                amplitude = scale * own[i]
                x[i] += np.rint(amplitude * cosine)
                y[i] += np.rint(amplitude * sine)


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
def plane_arguments(u, v, reach, forms, q):  # type: ignore[no-untyped-def]
    """Write form[0] u^2 + form[1] u v + form[2] v^2 of each source into its row of q.

    The cells are the first ``reach[i]`` of each row of the plane in turn.
    """
    for s in range(len(q)):
        a, b, c = forms[s]
        own, k = q[s], 0
        for i in range(u.size):
            first, second = a * u[i] * u[i], b * u[i]
            for j in range(reach[i]):
                own[k + j] = first + (second + c * v[j]) * v[j]
            k += reach[i]


@compiled
def plane_spectra(envelopes, taper, reach, along_u, along_v, spectra):  # type: ignore[no-untyped-def]
    """Write the product of envelope, taper, and the phases of both axes of each source; zero beyond the reach."""
    for s in range(len(spectra)):
        own, phase_u, phase_v, k = envelopes[s], along_u[s], along_v[s], 0
        for i in range(reach.size):
            row, of_row = spectra[s, i], phase_u[i]
            for j in range(reach[i]):
                row[j] = (own[k + j] * taper[k + j]) * (of_row * phase_v[j])
            row[reach[i] :] = 0
            k += reach[i]


@compiled
def axis_phases(offsets, k, phases):  # type: ignore[no-untyped-def]
    """Write (-1)^j exp(-2 pi i offset k_j) of each source into its row; the sign moves the origin to the centre."""
    for s in range(len(phases)):
        for j in range(k.size):
            angle = -2 * math.pi * offsets[s] * k[j]
            sign = 1 - 2 * (j % 2)
            phases[s, j] = complex(sign * math.cos(angle), sign * math.sin(angle))


@compiled
def add_stamps(stamps, flux, corners, image):  # type: ignore[no-untyped-def]
    """Add flux times stamp of each source to an image, with the stamp's first pixel at its corner."""
    for s in range(len(stamps)):
        for i in range(stamps.shape[1]):
            row = image[corners[s, 0] + i, corners[s, 1] :]
            own, scale = stamps[s, i], flux[s]
            for j in range(own.size):
                row[j] += scale * own[j]


@compiled
def plane_change(new, old, taper, reach, beam, spectrum):  # type: ignore[no-untyped-def]
    """Write the change of a source, times a beam, and return its power: the sum over the whole plane.

    ``new`` and ``old`` are the envelopes of the source and the phases of both axes, those along u with its flux.
    """
    new_envelope, new_u, new_v = new
    old_envelope, old_u, old_v = old
    power, k, last = 0.0, 0, old_v.size - 1
    for i in range(reach.size):
        of_new, of_old, own_beam, own = new_u[i], old_u[i], beam[i], spectrum[i]
        for j in range(reach[i]):
            now, before = of_new * new_v[j], of_old * old_v[j]
            first, second = new_envelope[k + j], old_envelope[k + j]
            real = taper[k + j] * (first * now.real - second * before.real)
            imaginary = taper[k + j] * (first * now.imag - second * before.imag)
            own[j] = complex(real, imaginary)
        own[reach[i] :] = 0
        # In a loop that writes, the last bits of the sum would depend on where the arrays lie in memory.
        of_row = taper.dtype.type(0)
        for j in range(reach[i]):
            of_row += own_beam[j] * (own[j].real * own[j].real + own[j].imag * own[j].imag)
        power += 2 * float(of_row)
        # This is half of the plane: the columns v = 0 and that of the Nyquist frequency count once.
        for j in (0, last):
            power -= own_beam[j] * (own[j].real ** 2 + own[j].imag ** 2)
        for j in range(reach[i]):
            own[j] *= own_beam[j]
        k += reach[i]
    return power
