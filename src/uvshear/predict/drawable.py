"""Galaxies that are drawn for a simulation, and the tiles on which this costs least."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.galaxy import Galaxies, Profile
from uvshear.geometry.directions import n_minus_one
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.imaging.bands import Band
from uvshear.numerics.fft_sizes import fast_size
from uvshear.typing import Array, Float, Int

RELATIVE_ERROR = 1e-6
"""Rms error of a galaxy's visibilities (of their complex modulus) from drawing and gridding, divided by its flux."""

STEP = 0.1
"""Step in u and v with which the Laplacian of an envelope is computed, in units of 1/(2 pi alpha), where alpha is the
scale length along the major axis."""

LEAST_SIZE = 1e-12
"""Smallest scale length that is used; smaller sources are as good as points [rad]."""

SMALLEST_STAMP = 72
"""Smallest width of a stamp [pixels]. A galaxy that is smaller than a pixel is drawn with an error of 2e-7 of its
flux."""

LARGEST_STAMP = 320
"""Largest width of a stamp [pixels]; larger galaxies are summed."""

MOST_TILES = 16
"""Largest number of tiles along a side of the field."""

SUM, _STAMP, _SAMPLE, _PIXEL = 1.6, 14.0, 380.0, 22.0
"""Costs on one core [ns]: per source and sample in the direct sum, per pixel of a stamp, per sample of a tile, and per
pixel and w-plane of a tile."""

_IN_ROW = 110.0
"""Cost of a further channel of a sample of a tile [ns], whose kernels fall on the same pixels."""

_PLANES = 8
"""Number of w-planes that the gridder needs where w hardly matters."""


@dataclass(frozen=True)
class TileCosts:
    """Estimated times that the tiles of a band take on one core [ns].

    Parameters
    ----------
    tiles
        Number of tiles.
    drawing
        Time in which all galaxies are drawn.
    pixels
        Time that one call of the gridder takes for the pixels of a tile, whatever the number of samples.
    """

    tiles: int
    drawing: float
    pixels: float

    @classmethod
    def of_squares(
        cls, span: float, sizes: Float[Array, " source"], band: Band, w: float, side: int
    ) -> Self:
        """Estimate the times of a field that is divided into ``side`` x ``side`` squares.

        Parameters
        ----------
        span
            Width of the field [rad].
        sizes
            Widths of the stamps of its galaxies [pixels].
        band
            Range of the baselines, and the pixels.
        w
            Largest modulus of w [wavelengths].
        side
            Number of squares along a side of the field.
        """
        width = span / side + int(sizes.max()) * band.pixel
        planes = _PLANES + 2 * w * (width / 2) ** 2
        return cls(
            tiles=min(side**2, len(sizes)),
            drawing=_STAMP * float(np.sum(sizes**2)),
            pixels=_PIXEL * planes * (width / band.pixel) ** 2,
        )

    def call(self, rows: int, channels: int) -> float:
        """Estimate the time of one call of the gridder, which degrids one tile."""
        return rows * (_SAMPLE + _IN_ROW * (channels - 1)) + self.pixels


NO_TILES = TileCosts(0, 0.0, 0.0)
"""Costs where nothing is drawn."""


def relative_error(
    galaxies: Galaxies, uvw: Float[Array, "probe 3"], profile: Profile
) -> Float[Array, " source"]:
    r"""Estimate the rms difference between a galaxy's visibilities from images and from the direct sum, over its flux.

    It includes the error of gridding.

    Images have the phase -pi w r^2 across a galaxy, with w along the galaxy's direction, and the sum does not. To first
    order it changes a visibility by

    .. math:: \frac{i w}{4\pi} \nabla^2 \tilde I(u, v)

    Parameters
    ----------
    galaxies
        The galaxies.
    uvw
        Baselines that represent the samples [wavelengths].
    profile
        Brightness profile of all galaxies.
    """
    l, m, n = galaxies.l, galaxies.m, 1 + n_minus_one(galaxies.l, galaxies.m)
    a, b, c = (
        4 * math.pi**2 * x for x in quadratic_form(galaxies.ellipticity, galaxies.scale_length)
    )
    step = STEP / (2 * math.pi * np.maximum(_long_axis(galaxies), LEAST_SIZE))
    square = np.zeros(len(galaxies))
    for u, v, w in uvw:
        x, y = u - w * l / n, v - w * m / n
        around = sum(
            profile.envelope(a * p**2 + b * p * q + c * q**2)
            for p, q in ((x + step, y), (x - step, y), (x, y + step), (x, y - step))
        )
        laplacian = (around - 4 * profile.envelope(a * x**2 + b * x * y + c * y**2)) / step**2
        square += ((u * l + v * m + w * n) / (4 * math.pi) * laplacian) ** 2
    return np.sqrt(RELATIVE_ERROR**2 + square / max(len(uvw), 1))


def suited(
    errors: Float[Array, " source"], sizes: Float[Array, " source"], error: float
) -> Int[Array, " member"]:
    """Return the indices of the galaxies that are drawn.

    They are the galaxies whose stamps are at most ``LARGEST_STAMP`` wide, beginning with the smallest errors, as long
    as the root of the sum of the squared errors is at most ``error`` [Jy].

    Each galaxy has one of the ``errors``, which is its rms error when drawn [Jy], and one of the ``sizes``, the width
    of its stamp [pixels].
    """
    small = np.flatnonzero(sizes <= LARGEST_STAMP)
    order = small[np.argsort(errors[small], kind="stable")]
    return np.sort(order[np.sqrt(np.cumsum(errors[order] ** 2)) <= error])


def cheapest_side(
    galaxies: Galaxies, band: Band, samples: int, w: float, profile: Profile
) -> tuple[int, TileCosts] | None:
    """Return the number of tiles along a side of the field that costs least, and what it costs.

    Where the direct sum costs less, the function returns None. ``samples`` is the number of visibilities in the band,
    and ``w`` the largest modulus of w [wavelengths].
    """
    if len(galaxies) == 0 or samples == 0:
        return None
    span = max(float(np.ptp(galaxies.l)), float(np.ptp(galaxies.m)))
    sizes = stamp_sizes(galaxies, band.pixel, profile)

    def costs(side: int) -> TileCosts:
        return TileCosts.of_squares(span, sizes, band, w, side)

    def cost(side: int) -> float:
        of_side = costs(side)
        return of_side.tiles * (_SAMPLE * samples + of_side.pixels) + of_side.drawing

    side = min(range(1, MOST_TILES + 1), key=cost)
    return (side, costs(side)) if cost(side) < SUM * samples * len(galaxies) else None


def stamp_sizes(galaxies: Galaxies, pixel: float, profile: Profile) -> Float[Array, " source"]:
    """Return the width of each galaxy's stamp [pixels]; infinite for a profile of unknown extent."""
    if math.isinf(profile.extent):
        return np.full(len(galaxies), math.inf)
    widths = np.maximum(np.ceil(2 * profile.extent * _long_axis(galaxies) / pixel), SMALLEST_STAMP)
    return np.array([fast_size(width) for width in widths.tolist()], float)


def _long_axis(galaxies: Galaxies) -> Float[Array, " source"]:
    """Scale length along the major axis [rad]."""
    return galaxies.scale_length / (1 - np.abs(galaxies.ellipticity))
