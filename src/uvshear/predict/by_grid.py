"""Visibilities of galaxies from images of them: the error is a small fraction of the noise, and the cost of the sum's.

Baselines are divided into octaves of their length. For each octave the field is divided into square tiles. The galaxies
of a tile are drawn in the frame of its centre (``geometry.tangent_frame``), where few w-planes are needed, and
degridded. The longest baselines are few and would need the largest images: an octave for which the images would cost
more than the sum is summed (``direct``), and so are galaxies that are too bright or too large for the images.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Exponential, Galaxies, Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.geometry.tangent_frame import TangentFrame
from uvshear.imaging.bands import Band, longest_seen, steepest
from uvshear.imaging.grid import ImageGrid
from uvshear.imaging.gridder import degrid
from uvshear.imaging.tiles import Tile
from uvshear.imaging.uv_order import uv_order
from uvshear.numerics.fft_sizes import fast_size
from uvshear.predict.direct import largest_flux, precision_within, predict_visibilities
from uvshear.predict.rendering import Stamps, draw
from uvshear.predict.response import SharedFactors
from uvshear.typing import Array, Complex, Float, Int

EPSILON = 2e-6
"""Relative error of the gridder."""

RELATIVE_ERROR = 1e-6
"""Root mean square error of a galaxy's visibilities over its flux, by drawing and gridding."""

CURVATURE = 6 * math.pi
"""Mean phase error of the sum that images do not have, pi <r^2> w [rad], over w alpha^2: <r^2> is 6 alpha^2 for a round
exponential disc, and no more for other profiles that are drawn."""

FOR_IMAGES = 0.9
"""Part of the error that images may have; the rest is for the rounding of the sum."""

SPECTRAL_TOLERANCE = 1e-6
"""Error of a spectrum that is a combination of others."""

OVERSAMPLING = 1.4
"""Nyquist frequency of an octave's pixels over its longest baseline."""

STEEPNESS, SMALLEST_STAMP = 14.0, 72
"""Shape parameter of the taper between the longest baseline and the Nyquist frequency, and the smallest width of a
stamp [pixels]. A galaxy that is smaller than a pixel is drawn with an error of 2e-7 of its flux."""

LARGEST_STAMP = 320
"""Largest width of a stamp [pixels]; larger galaxies are summed."""

FEWEST_PIXELS = 256
"""Width of the image of the whole field below which baselines are not divided further [pixels]."""

MOST_TILES = 16
"""Largest number of tiles along a side of the field."""

SLAB = 2**20
"""Largest number of visibilities that one call of the gridder computes. It does not depend on the number of workers, so
that the result does not either."""

_SUM, _STAMP, _SAMPLE, _PIXEL = 1.6, 14.0, 380.0, 22.0
"""Costs on one core [ns]: of a source and a sample in the sum, of a pixel of a stamp, of a sample of a tile, and of a
pixel of a tile for each w-plane."""

_PLANES = 8
"""Number of w-planes that the gridder needs where w hardly matters."""


def predict_by_grid(
    galaxies: Galaxies,
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    error: float,
    profile: Profile | None = None,
    executor: Executor = SERIAL,
) -> Complex[Array, "row chan"]:
    """Approximate what ``predict_visibilities`` computes [Jy], with a given rms error at most.

    The result does not depend on the executor, bit for bit. Images have the w term across each galaxy, of which the sum
    has the first order alone.

    Parameters
    ----------
    galaxies
        Galaxies of the sky, with l^2 + m^2 < 1.
    uvw
        Baselines [m].
    frequency
        Channel centres, in rising order [Hz].
    error
        Root mean square of the error that is allowed [Jy]; galaxies for which images would be worse are summed.
    profile
        Brightness profile of all galaxies; exponential unless given.
    executor
        Executor for tiles and slabs of samples.
    """
    profile = profile or Exponential()
    vis = np.zeros((len(uvw), len(frequency)), complex)
    per_metre = float(frequency.max()) / SPEED_OF_LIGHT
    distance = np.hypot(uvw[:, 0], uvw[:, 1]) * per_metre
    slope = steepest(galaxies.l, galaxies.m)
    length = longest_seen(uvw, slope) * per_metre
    # In the frame of a tile, w is that along the direction of its centre.
    w = np.abs(uvw[:, 2]) * per_metre + slope * distance

    def add_sum(part: Galaxies, rows: Int[Array, " _"]) -> None:
        if len(part) and len(rows):
            dtype = precision_within(error, largest_flux(part, frequency))
            vis[rows] += predict_visibilities(
                part, uvw[rows], frequency, profile, executor, dtype=dtype
            )

    everything, flux = np.arange(len(galaxies)), largest_flux(galaxies, frequency)
    for band in _octaves(length, galaxies):
        rows = np.flatnonzero(band.holds(length))
        rows = rows[uv_order(uvw[rows])]
        reach = float(w[rows].max(initial=0.0))
        least = (band.shortest - 2 * slope * reach) * float(frequency.min() / frequency.max())
        typical = float(np.sqrt(np.mean(w[rows] ** 2))) if len(rows) else 0.0
        wrong = flux * _relative_error(galaxies, max(least, 0.0), typical, profile)
        suited = _suited(wrong, _stamp_sizes(galaxies, band.pixel, profile), FOR_IMAGES * error)
        samples = len(rows) * len(frequency)
        side = _cheapest_side(galaxies.select(suited), band, samples, reach, profile)
        if side is not None:
            octave = _Octave(rows, band, _squares(galaxies, suited, side))
            vis[rows] = _visibilities(octave, uvw, frequency, galaxies, profile, executor)
            add_sum(galaxies.select(np.setdiff1d(everything, suited)), rows)
        else:
            add_sum(galaxies, rows)
    return vis


def _octaves(length: Float[Array, " row"], galaxies: Galaxies) -> Iterator[Band]:
    """Divide baselines of these lengths [wavelengths], from the longest down; the last band is all that remains."""
    if len(galaxies) == 0 or len(length) == 0:
        return
    if length.max() == 0:
        yield Band(0.0, 1.0, 1.0)
        return
    span = max(float(np.ptp(galaxies.l)), float(np.ptp(galaxies.m)))
    longest, is_last = float(length.max()) * (1 + 1e-9), False
    while not is_last:
        pixel = 1 / (2 * OVERSAMPLING * longest)
        is_last = not span / pixel >= FEWEST_PIXELS
        yield Band(0.0 if is_last else longest / 2, longest, pixel)
        longest /= 2


def _relative_error(
    galaxies: Galaxies, shortest: float, w: float, profile: Profile
) -> Float[Array, " source"]:
    """Estimate the difference between images and the sum, over each galaxy's flux.

    ``shortest`` is the shortest baseline that a galaxy sees, and ``w`` is the root mean square of w [wavelengths].
    """
    modulus = np.abs(galaxies.ellipticity)
    short_axis, long_axis = (galaxies.scale_length / (1 + sign * modulus) for sign in (1, -1))
    left = np.abs(profile.envelope((2 * math.pi * short_axis * shortest) ** 2))
    curved = CURVATURE * w * (short_axis**2 + long_axis**2) / 2 * left
    return np.hypot(RELATIVE_ERROR, curved)


def _suited(
    wrong: Float[Array, " source"], sizes: Float[Array, " source"], error: float
) -> Int[Array, " member"]:
    """Return the galaxies that are drawn: of those whose stamps are small, as many as the error allows [Jy].

    ``wrong`` is the error of each galaxy [Jy], and ``sizes`` are the widths of the stamps [pixels].
    """
    small = np.flatnonzero(sizes <= LARGEST_STAMP)
    order = small[np.argsort(wrong[small], kind="stable")]
    return np.sort(order[np.sqrt(np.cumsum(wrong[order] ** 2)) <= error])


def _cheapest_side(
    galaxies: Galaxies, band: Band, samples: int, w: float, profile: Profile
) -> int | None:
    """Return the number of tiles along a side of the field that costs least; None where the sum costs less.

    ``w`` is the largest in the band [wavelengths].
    """
    if len(galaxies) == 0 or samples == 0:
        return None
    span = max(float(np.ptp(galaxies.l)), float(np.ptp(galaxies.m)))
    sizes = _stamp_sizes(galaxies, band.pixel, profile)

    def cost(side: int) -> float:
        width = span / side + int(sizes.max()) * band.pixel
        planes = _PLANES + 2 * w * (width / 2) ** 2
        each = _SAMPLE * samples + _PIXEL * planes * (width / band.pixel) ** 2
        return min(side**2, len(galaxies)) * each + _STAMP * float(np.sum(sizes**2))

    side = min(range(1, MOST_TILES + 1), key=cost)
    return side if cost(side) < _SUM * samples * len(galaxies) else None


@dataclass(frozen=True)
class _Octave:
    """Rows whose baselines lie in one band, and the tiles that are drawn for them.

    Parameters
    ----------
    rows
        Numbers of the rows.
    band
        Range of the lengths, and the pixels.
    tiles
        Numbers of the galaxies of each tile.
    """

    rows: Int[Array, " row"]
    band: Band
    tiles: Sequence[Int[Array, " _"]]


def _squares(
    galaxies: Galaxies, chosen: Int[Array, " member"], side: int
) -> list[Int[Array, " _"]]:
    """Divide the field into ``side`` x ``side`` squares; return the chosen galaxies in each that has any."""
    place = np.column_stack([galaxies.l, galaxies.m])[chosen]
    low = place.min(axis=0)
    width = max(float(np.ptp(place, axis=0).max()), 1e-300) / side
    square = np.minimum(((place - low) / width).astype(int), side - 1)
    number = square[:, 0] * side + square[:, 1]
    return [chosen[number == k] for k in np.unique(number)]


def _stamp_sizes(galaxies: Galaxies, pixel: float, profile: Profile) -> Float[Array, " source"]:
    """Return the width of each galaxy's stamp [pixels]; infinite for a profile of unknown extent."""
    if math.isinf(profile.extent):
        return np.full(len(galaxies), math.inf)
    long_axis = galaxies.scale_length / (1 - np.abs(galaxies.ellipticity))
    widths = np.maximum(np.ceil(2 * profile.extent * long_axis / pixel), SMALLEST_STAMP)
    return np.array([fast_size(width) for width in widths.tolist()], float)


def _visibilities(
    octave: _Octave,
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    galaxies: Galaxies,
    profile: Profile,
    executor: Executor,
) -> Complex[Array, "chosen chan"]:
    """Predict the rows of an octave, tile by tile."""
    spectra = (frequency[:, None] / galaxies.reference_frequency) ** galaxies.spectral_index
    shared = SharedFactors.from_factors(spectra, SPECTRAL_TOLERANCE)
    images = [
        (members, spectra[:, source], coefficients)
        for members in octave.tiles
        for source, coefficients in zip(shared.chosen.tolist(), shared.coefficients, strict=True)
    ]

    def drawn(task: tuple[Int[Array, " member"], Array, Array]) -> _TileImage:
        members, spectrum, coefficients = task
        taken = galaxies.select(members)
        return _drawn(taken, taken.flux * coefficients[members], spectrum, octave.band, profile)

    per_slab = max(1, SLAB // len(frequency))
    starts = range(0, len(octave.rows), per_slab)

    def seen(task: tuple[_TileImage, int]) -> tuple[int, Complex[Array, "slab chan"]]:
        image, start = task
        return start, image.visibilities(uvw[octave.rows[start : start + per_slab]], frequency)

    vis = np.zeros((len(octave.rows), len(frequency)), complex)
    tasks = ((image, start) for image in executor.map(drawn, images) for start in starts)
    for start, part in executor.map(seen, tasks):
        vis[start : start + per_slab] += part
    return vis


@dataclass(frozen=True)
class _TileImage:
    """Image of the galaxies of a tile, in the frame of its centre, and their spectrum."""

    frame: TangentFrame
    image: Float[Array, "l m"]
    grid: ImageGrid
    spectrum: Float[Array, " chan"]

    def visibilities(
        self, uvw: Float[Array, "row 3"], frequency: Float[Array, " chan"]
    ) -> Complex[Array, "row chan"]:
        """Visibilities of the tile [Jy] for baselines in metres."""
        vis = degrid(
            self.frame.baselines(uvw),
            frequency,
            self.image,
            self.grid,
            epsilon=EPSILON,
            with_w=True,
        )
        turns = np.outer(self.frame.turns(uvw), frequency / SPEED_OF_LIGHT)
        return vis * (np.exp(2j * math.pi * (turns - np.rint(turns))) * self.spectrum)


def _drawn(
    galaxies: Galaxies,
    flux: Float[Array, " source"],
    spectrum: Float[Array, " chan"],
    band: Band,
    profile: Profile,
) -> _TileImage:
    """Draw galaxies on a tile about their middle."""
    middle = [float(x.min() + x.max()) / 2 for x in (galaxies.l, galaxies.m)]
    frame = TangentFrame.at(*middle)
    place = np.column_stack(frame.directions(galaxies.l, galaxies.m))
    forms = np.stack(quadratic_form(galaxies.ellipticity, galaxies.scale_length), axis=-1)
    forms = frame.forms(galaxies.l, galaxies.m, forms)
    sizes = _stamp_sizes(galaxies, band.pixel, profile).astype(int)
    nearest = np.rint(place / band.pixel).astype(int)
    half = sizes[:, None] // 2 + 1
    # The centre of the frame is the middle pixel.
    size = 2 * int(np.max(np.abs(nearest) + half))
    tile = Tile(0, (-size // 2, -size // 2), size, np.arange(len(galaxies)), -1)
    image = draw(Stamps(place, forms, flux, sizes.tolist(), STEEPNESS), tile, band, profile)
    return _TileImage(frame, image, ImageGrid(size, band.pixel), spectrum)
