"""Numba kernels of images and of their samples."""

from uvshear.compilation import compiled
from uvshear.geometry.kernels import sine_cosine_of_turns


@compiled
def rotate_phase(uvw, per_metre, lmn1, vis, rotated):  # type: ignore[no-untyped-def]
    """Multiply by exp(-2 pi i (u l + v m + w (n-1))), which moves the phase centre to (l, m)."""
    l, m, n1 = lmn1[0] * per_metre, lmn1[1] * per_metre, lmn1[2] * per_metre
    for i in range(vis.size):
        sine, cosine = sine_cosine_of_turns(uvw[0, i] * l + uvw[1, i] * m + uvw[2, i] * n1)
        real, imaginary = vis[i].real, vis[i].imag
        rotated[i] = complex(real * cosine + imaginary * sine, imaginary * cosine - real * sine)


@compiled
def to_tangent_plane(uvw, lmn1, surface, baselines, real, imaginary):  # type: ignore[no-untyped-def]
    """Write the baselines [wavelengths] of the plane tangent at a direction, and the phase there.

    These are (u - w l/n, v - w m/n, c w) and exp(2 pi i (u l + v m + w (n-1))), with (l/n, m/n, c) the slopes and the
    mean curvature of n.
    """
    l, m, n1 = lmn1
    slope_l, slope_m, curvature = surface
    for i in range(real.size):
        u, v, w = uvw[i, 0], uvw[i, 1], uvw[i, 2]
        baselines[i, 0] = u - w * slope_l
        baselines[i, 1] = v - w * slope_m
        baselines[i, 2] = curvature * w
        sine, cosine = sine_cosine_of_turns(u * l + v * m + w * n1)
        real[i] = cosine
        imaginary[i] = sine


@compiled
def add_times_series(w, scale, series, vis, total):  # type: ignore[no-untyped-def]
    """Add ``vis`` times a sum of Chebyshev polynomials of ``scale`` w, with complex coefficients ``series``."""
    real, imaginary = series.real, series.imag
    for i in range(vis.size):
        x = 2 * scale * w[i]
        # The recurrence of Clenshaw.
        a = b = c = d = 0.0
        for k in range(series.size - 1, 0, -1):
            a, b = real[k] + x * a - b, a
            c, d = imaginary[k] + x * c - d, c
        p = real[0] + x / 2 * a - b
        q = imaginary[0] + x / 2 * c - d
        total[i] += complex(p * vis[i].real - q * vis[i].imag, p * vis[i].imag + q * vis[i].real)


@compiled
def add_times_polynomial(coefficients, part, total):  # type: ignore[no-untyped-def]
    """Add an image times a polynomial of t, which is -1 at the pixel (size // 2, size // 2) and 1 in the corners.

    The distance from that pixel, squared, is proportional to t + 1.
    """
    size = part.shape[0]
    half, powers = size // 2, coefficients.astype(part.dtype)
    unit = 4.0 / size**2
    for i in range(size):
        first, own, into = unit * (i - half) ** 2 - 1, part[i], total[i]
        for j in range(size):
            t = powers.dtype.type(first + unit * (j - half) ** 2)
            value = powers[-1]
            for k in range(powers.size - 2, -1, -1):
                value = value * t + powers[k]
            into[j] += value * own[j]


@compiled
def number_squares(uvw, per_unit, side, square):  # type: ignore[no-untyped-def]
    """Write the number of the square of the uv plane in which each sample lies; neighbours have the next number."""
    for i in range(square.size):
        row = min(int(uvw[i, 0] * per_unit + side / 2), side - 1)
        column = min(int(uvw[i, 1] * per_unit + side / 2), side - 1)
        square[i] = row * side + (side - 1 - column if row % 2 else column)


@compiled
def gather_cells(spectrum, row, column, scale, place, facet):  # type: ignore[no-untyped-def]
    """Add ``scale`` times the conjugate of some cells of a spectrum to a facet, at the given places."""
    for k in range(place.size):
        found = spectrum[row[k], column[k]]
        facet[place[k]] += complex(scale[k] * found.real, -scale[k] * found.imag)


@compiled
def turn_cells(along_u, along_v, row, column, facet):  # type: ignore[no-untyped-def]
    """Multiply the cells of a facet by the phases of their row and column."""
    for k in range(facet.size):
        facet[k] *= along_u[row[k]] * along_v[column[k]]


@compiled
def refine(coarse, shift_l, shift_m, weights, row, between, fine):  # type: ignore[no-untyped-def]
    """Add a coarse image to a finer one; ``interpolation`` describes the arguments.

    ``weights`` are those of a point half-way between two coarse pixels. ``row`` and ``between`` are work space, for the
    coarse pixels of a row and for the points half-way between them.
    """
    taps, size = weights.size // 2, fine.shape[1]
    first = shift_m // 2 - taps + 1
    count = (shift_m + size - 1) // 2 + taps - first + 1
    even, odd = shift_m % 2, 1 - shift_m % 2
    many = (size - odd + 1) // 2
    start = (shift_m + odd - 1) // 2 - taps + 1 - first
    for x in range(fine.shape[0]):
        middle, is_between = (shift_l + x) // 2, (shift_l + x) % 2
        if is_between:
            row[:count] = 0
            for k in range(2 * taps):
                weight, source = weights[k], coarse[middle - taps + 1 + k, first : first + count]
                for i in range(count):
                    row[i] += weight * source[i]
        else:
            row[:count] = coarse[middle, first : first + count]
        between[:many] = 0
        for k in range(2 * taps):
            weight, source = weights[k], row[start + k : start + k + many]
            for i in range(many):
                between[i] += weight * source[i]
        into = fine[x]
        at = (shift_m + even) // 2 - first
        for i in range((size - even + 1) // 2):
            into[even + 2 * i] += row[at + i]
        for i in range(many):
            into[odd + 2 * i] += between[i]
