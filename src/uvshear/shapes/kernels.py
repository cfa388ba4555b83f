"""Numba kernels of the fits; each of them makes one pass over the cells of a facet, in the dtype of the cells.

Sums run in that dtype over blocks of 256 cells, and in float64 over the blocks.
"""

import math

import numpy as np

from uvshear.compilation import compiled
from uvshear.geometry.kernels import sine_cosine_of_turns, sine_cosine_of_turns_single

BLOCK = 256


@compiled
def quadratic(x, y, form, q):  # type: ignore[no-untyped-def]
    """Write form[0] x^2 + form[1] x y + form[2] y^2 into q."""
    a, b, c = form.astype(q.dtype)
    for i in range(q.size):
        q[i] = a * x[i] * x[i] + b * x[i] * y[i] + c * y[i] * y[i]


@compiled
def quadratics(x, y, forms, q):  # type: ignore[no-untyped-def]
    """Write the quadratic form of each template (row) into q (template, cell)."""
    for t in range(len(forms)):
        a, b, c = forms[t].astype(q.dtype)
        for i in range(x.size):
            q[t, i] = a * x[i] * x[i] + b * x[i] * y[i] + c * y[i] * y[i]


@compiled
def add_norms(envelopes, power, norms):  # type: ignore[no-untyped-def]
    """Add <m, m> of each template over these cells to ``norms``."""
    for t in range(len(envelopes)):
        partial = power.dtype.type(0)
        for i in range(power.size):
            partial += power[i] * envelopes[t, i] * envelopes[t, i]
        norms[t] += partial


@compiled
def normal_sums(  # type: ignore[no-untyped-def]
    envelope, slope, x, y, forms, real, imaginary, power, sums
):
    """Write the Gauss-Newton sums for unit flux; ``normal_sums.NormalSums`` names them.

    The responses are V to the flux, and V' dq/dp to p = e1, e2, ln alpha with dq/dp the quadratic forms ``forms``;
    those to the position, i x V and i y V, are imaginary and decouple. Into ``sums`` go the four products of the
    responses with the data, their ten products with one another weighted by the power (the upper triangle by rows),
    two sums for the gradient with respect to the position, and three for its curvature.
    """
    zero = x.dtype.type(0)
    f = forms.astype(x.dtype)
    for k in range(19):
        sums[k] = 0.0
    for start in range(0, x.size, BLOCK):
        d0 = d1 = d2 = d3 = zero
        n00 = n01 = n02 = n03 = n11 = n12 = n13 = n22 = n23 = n33 = zero
        gx = gy = cxx = cxy = cyy = zero
        for i in range(start, min(start + BLOCK, x.size)):
            xx, xy, yy = x[i] * x[i], x[i] * y[i], y[i] * y[i]
            v = envelope[i]
            r1 = slope[i] * (f[0, 0] * xx + f[0, 1] * xy + f[0, 2] * yy)
            r2 = slope[i] * (f[1, 0] * xx + f[1, 1] * xy + f[1, 2] * yy)
            r3 = slope[i] * (f[2, 0] * xx + f[2, 1] * xy + f[2, 2] * yy)
            d0 += real[i] * v
            d1 += real[i] * r1
            d2 += real[i] * r2
            d3 += real[i] * r3
            pv, p1, p2, p3 = power[i] * v, power[i] * r1, power[i] * r2, power[i] * r3
            n00 += pv * v
            n01 += pv * r1
            n02 += pv * r2
            n03 += pv * r3
            n11 += p1 * r1
            n12 += p1 * r2
            n13 += p1 * r3
            n22 += p2 * r2
            n23 += p2 * r3
            n33 += p3 * r3
            odd = imaginary[i] * v
            gx += odd * x[i]
            gy += odd * y[i]
            cxx += pv * v * xx
            cxy += pv * v * xy
            cyy += pv * v * yy
        sums[0] += d0
        sums[1] += d1
        sums[2] += d2
        sums[3] += d3
        sums[4] += n00
        sums[5] += n01
        sums[6] += n02
        sums[7] += n03
        sums[8] += n11
        sums[9] += n12
        sums[10] += n13
        sums[11] += n22
        sums[12] += n23
        sums[13] += n33
        sums[14] += gx
        sums[15] += gy
        sums[16] += cxx
        sums[17] += cxy
        sums[18] += cyy


@compiled
def displace(x, y, shift_x, shift_y, real, imaginary, new_real, new_imaginary):  # type: ignore[no-untyped-def]
    """Multiply by exp(-i (x shift_x + y shift_y)), which moves a source at the shift to the centre."""
    a, b = shift_x / (2 * math.pi), shift_y / (2 * math.pi)
    for i in range(x.size):
        sine, cosine = sine_cosine_of_turns(x[i] * a + y[i] * b)
        new_real[i] = real[i] * cosine + imaginary[i] * sine
        new_imaginary[i] = imaginary[i] * cosine - real[i] * sine


@compiled
def displace_single(x, y, shift_x, shift_y, real, imaginary, new_real, new_imaginary):  # type: ignore[no-untyped-def]
    """Do the same as :func:`displace` with phases in single precision."""
    a, b = shift_x / (2 * math.pi), shift_y / (2 * math.pi)
    for i in range(x.size):
        sine, cosine = sine_cosine_of_turns_single(x[i] * a + y[i] * b)
        new_real[i] = real[i] * cosine + imaginary[i] * sine
        new_imaginary[i] = imaginary[i] * cosine - real[i] * sine


@compiled
def displaced_sums(x, y, shift_x, shift_y, real, imaginary):  # type: ignore[no-untyped-def]
    """Sum the real part of what :func:`displace` writes, and the products of the imaginary part with x and y."""
    a, b = shift_x / (2 * math.pi), shift_y / (2 * math.pi)
    total = along_x = along_y = 0.0
    for i in range(x.size):
        sine, cosine = sine_cosine_of_turns(x[i] * a + y[i] * b)
        total += real[i] * cosine + imaginary[i] * sine
        odd = imaginary[i] * cosine - real[i] * sine
        along_x += odd * x[i]
        along_y += odd * y[i]
    return total, along_x, along_y


@compiled
def turn(uv, x, y, phase):  # type: ignore[no-untyped-def]
    """Write exp(2 pi i (u x + v y)) of each cell, in single precision."""
    for i in range(phase.size):
        sine, cosine = sine_cosine_of_turns_single(uv[i, 0] * x + uv[i, 1] * y)
        phase[i] = complex(cosine, sine)


@compiled
def argument(uv, form, q):  # type: ignore[no-untyped-def]
    """Write form[0] u^2 + form[1] u v + form[2] v^2 into q."""
    a, b, c = form
    for i in range(q.size):
        u, v = uv[i, 0], uv[i, 1]
        q[i] = a * u * u + b * u * v + c * v * v


@compiled
def respond(uv, phase, envelope, slope, by_shape, flux, out):  # type: ignore[no-untyped-def]
    """Write the derivatives of flux * envelope * phase with respect to flux, e1, e2, ln alpha, l, m, one row each.

    ``slope`` is d(envelope)/dq, and the rows of ``by_shape`` hold the derivatives of the coefficients of q.
    """
    u, v = uv[:, 0], uv[:, 1]
    by_flux, by_l, by_m = out[0], out[4], out[5]
    for row in range(3):
        a, b, c = flux * by_shape[row, 0], flux * by_shape[row, 1], flux * by_shape[row, 2]
        own = out[1 + row]
        for i in range(phase.size):
            by_q = a * u[i] * u[i] + b * u[i] * v[i] + c * v[i] * v[i]
            own[i] = np.float32(slope[i] * by_q) * phase[i]
    scale = 2 * math.pi * flux
    for i in range(phase.size):
        by_flux[i] = envelope[i] * phase[i]
        turned = complex(-by_flux[i].imag, by_flux[i].real)
        by_l[i] = np.float32(scale * u[i]) * turned
        by_m[i] = np.float32(scale * v[i]) * turned
