"""Visibilities of galaxies from images of them.

The error is a small fraction of the noise, and the cost a fraction of that of the direct sum.

Baselines are divided into octaves of their length. For each octave the field is divided into square tiles. The galaxies
of a tile are drawn in the frame of its centre (``geometry.tangent_frame``), where few w-planes are needed, and
degridded. The longest baselines are few and would need the largest images: an octave for which the images would cost
more than the sum is summed (``direct``), and so are galaxies that are too bright or too large for the images.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Self, TypeAlias

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Exponential, Galaxies, Profile
from uvshear.imaging.bands import Band, longest_seen, steepest
from uvshear.imaging.uv_order import uv_order
from uvshear.predict import direct
from uvshear.predict.direct import largest_flux, precision_within, predict_visibilities
from uvshear.predict.drawable import (
    NO_TILES,
    SUM,
    TileCosts,
    cheapest_side,
    relative_error,
    stamp_sizes,
    suited,
)
from uvshear.predict.prediction import Prediction
from uvshear.predict.response import SharedFactors
from uvshear.predict.tile_images import TileImage, draw_tile
from uvshear.progress import Meter, Progress
from uvshear.typing import Array, Complex, Float, Int

FOR_IMAGES = 0.9
"""Largest rms error of the images, divided by the allowed error. The rounding of the direct sum may have a third of the
allowed error (``direct.precision_within``); the two add in quadrature to 0.96."""

SPECTRAL_TOLERANCE = 1e-6
"""Relative error of the spectrum of a galaxy that is represented by a combination of others."""

OVERSAMPLING = 1.4
"""Ratio of the Nyquist frequency of an octave's pixels to its longest baseline."""

FEWEST_PIXELS = 256
"""Width of the image of the whole field below which baselines are not divided further [pixels]."""

PROBES = 64
"""Smallest number of baselines that represent an octave, if it has that many rows; the largest is just below twice as
many."""

GOLDEN_RATIO = (math.sqrt(5) - 1) / 2

SLAB = 2**20
"""Largest number of visibilities that one call of the gridder computes. It does not depend on the number of workers, so
that the result does not either."""


ROW, SAMPLE = 60.0, 15.0
"""Time of a baseline, and of each of its visibilities, in which they are put in place on one core [ns]."""

IN_A_SUM = 2**18
"""Number of visibilities that a task sums, if there are as many channels and rows in a slab."""


def predict_by_grid(
    galaxies: Galaxies,
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    error: float,
    profile: Profile | None = None,
    executor: Executor = SERIAL,
) -> Complex[Array, "row chan"]:
    """Approximate what ``predict_visibilities`` computes [Jy], with a given rms error at most.

    The result is the same for every executor, bit for bit. Images contain the w term across each galaxy to all orders;
    the direct sum contains only the first.

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
    planned = GridPrediction.planned(galaxies, uvw, frequency, error, profile, executor)
    return planned.visibilities(executor)


@dataclass(frozen=True)
class GridPrediction(Prediction):
    """Visibilities of galaxies that are predicted from images as far as this is faster.

    Parameters
    ----------
    galaxies, uvw, frequency, error, profile
        As for ``predict_by_grid``.
    octaves
        The octaves of the baselines.
    """

    galaxies: Galaxies
    uvw: Float[Array, "row 3"]
    frequency: Float[Array, " chan"]
    error: float
    profile: Profile
    octaves: Sequence["_Octave"]

    @classmethod
    def planned(
        cls,
        galaxies: Galaxies,
        uvw: Float[Array, "row 3"],
        frequency: Float[Array, " chan"],
        error: float,
        profile: Profile,
        executor: Executor = SERIAL,
    ) -> Self:
        """Decide for each octave which galaxies are drawn, and on which tiles."""
        octaves: list[_Octave] = []
        if len(galaxies):
            octaves = list(_planned(galaxies, uvw, frequency, error, profile, executor))
        return cls(galaxies, uvw, frequency, error, profile, octaves)

    @property
    def cost(self) -> float:
        """Estimated time on one core [ns]."""
        cost = 0.0
        for octave in self.octaves:
            cost += self._cost_of_sum(len(octave.summed), len(octave.rows) * len(self.frequency))
            each = sum(self._cost_of_slab(octave, len(slab)) for slab in self._slabs_of(octave))
            cost += len(self._shared.chosen) * (octave.costs.drawing + len(octave.tiles) * each)
        return cost

    def _cost_of_sum(self, summed: int, samples: int) -> float:
        return samples * (SUM * summed + self._elsewhere) if summed else 0.0

    def _cost_of_slab(self, octave: "_Octave", rows: int) -> float:
        channels = len(self.frequency)
        return octave.costs.call(rows, channels) + rows * channels * self._elsewhere

    @property
    def _elsewhere(self) -> float:
        """Time of a visibility in which its value is put in place [ns]."""
        return ROW / len(self.frequency) + SAMPLE

    def visibilities(
        self, executor: Executor = SERIAL, progress: Progress | None = None
    ) -> Complex[Array, "row chan"]:
        """Predict the visibilities [Jy]."""
        vis = np.zeros((len(self.uvw), len(self.frequency)), complex)
        meter = Meter(progress)
        meter.expect(self.cost)
        images: list[_Drawn] = []
        tasks: list[_Work] = [*self._drawings(), *self._summations(vis)]
        for cost, found in executor.map(_run, tasks):
            images += [] if found is None else [found]
            meter.add(cost)
        parts = ((each, rows) for each in images for rows in self._slabs_of(each.octave))
        for cost, rows, part in executor.map(self._degridded, parts):
            vis[rows] += part
            meter.add(cost)
        return vis

    @cached_property
    def _spectra(self) -> Float[Array, "chan source"]:
        ratio = self.frequency[:, None] / self.galaxies.reference_frequency
        return ratio**self.galaxies.spectral_index

    @cached_property
    def _shared(self) -> SharedFactors:
        return SharedFactors.from_factors(self._spectra, SPECTRAL_TOLERANCE)

    def _drawings(self) -> Iterator["_Work"]:
        for octave in self.octaves:
            for members in octave.tiles:
                for k in range(len(self._shared.chosen)):
                    yield partial(self._drawn, octave, members, k)

    def _drawn(
        self, octave: "_Octave", members: Int[Array, " member"], k: int
    ) -> tuple[float, "_Drawn"]:
        taken, weight = self.galaxies.select(members), self._shared.coefficients[k, members]
        spectrum = self._spectra[:, self._shared.chosen[k]]
        image = draw_tile(taken, taken.flux * weight, spectrum, octave.band, self.profile)
        return octave.costs.drawing * len(members) / octave.drawn, _Drawn(octave, image)

    def _summations(self, vis: Complex[Array, "row chan"]) -> Iterator["_Work"]:
        """Yield sums over galaxies, which are written to ``vis``."""
        for octave in self.octaves:
            if len(octave.summed):
                for rows in _slabs(octave.rows, direct.SLAB):
                    step = max(1, IN_A_SUM // len(rows))
                    for first in range(0, len(self.frequency), step):
                        channels = slice(first, first + step)
                        yield partial(self._sum, vis, octave.summed, rows, channels)

    def _sum(
        self,
        vis: Complex[Array, "row chan"],
        summed: Int[Array, " member"],
        rows: Int[Array, " slab"],
        channels: slice,
    ) -> tuple[float, None]:
        part, frequency = self.galaxies.select(summed), self.frequency[channels]
        dtype = precision_within(self.error, largest_flux(part, self.frequency))
        vis[rows, channels] = predict_visibilities(
            part, self.uvw[rows], frequency, self.profile, dtype=dtype
        )
        return self._cost_of_sum(len(part), len(rows) * len(frequency)), None

    def _degridded(
        self, task: tuple["_Drawn", Int[Array, " slab"]]
    ) -> tuple[float, Int[Array, " slab"], Complex[Array, "slab chan"]]:
        drawn, rows = task
        part = drawn.image.visibilities(self.uvw[rows], self.frequency)
        return self._cost_of_slab(drawn.octave, len(rows)), rows, part

    def _slabs_of(self, octave: "_Octave") -> Iterator[Int[Array, " slab"]]:
        return _slabs(octave.rows, max(1, SLAB // len(self.frequency)))


@dataclass(frozen=True)
class _Octave:
    """Rows whose baselines lie in one band, and how their galaxies are predicted.

    Parameters
    ----------
    rows
        Numbers of the rows.
    band
        Range of the lengths, and the pixels.
    tiles
        Numbers of the galaxies of each tile that is drawn.
    summed
        Numbers of the galaxies that are summed.
    costs
        Estimated times of the tiles.
    """

    rows: Int[Array, " row"]
    band: Band
    tiles: Sequence[Int[Array, " _"]]
    summed: Int[Array, " _"]
    costs: TileCosts = NO_TILES

    @property
    def drawn(self) -> int:
        """Number of the galaxies that are drawn."""
        return sum(len(tile) for tile in self.tiles)


@dataclass(frozen=True)
class _Drawn:
    """An image, and the octave that sees it."""

    octave: _Octave
    image: TileImage


_Work: TypeAlias = Callable[[], tuple[float, _Drawn | None]]
"""A drawing or a sum, which returns its estimated time on one core [ns] and the image."""


def _run(task: _Work) -> tuple[float, _Drawn | None]:
    return task()


def _slabs(rows: Int[Array, " row"], size: int) -> Iterator[Int[Array, " slab"]]:
    for start in range(0, len(rows), size):
        yield rows[start : start + size]


def _planned(
    galaxies: Galaxies,
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    error: float,
    profile: Profile,
    executor: Executor,
) -> Iterator[_Octave]:
    """Decide for each octave which galaxies are drawn, on which tiles, and which are summed."""
    per_metre = float(frequency.max()) / SPEED_OF_LIGHT
    slope = steepest(galaxies.l, galaxies.m)
    # In the frame of a tile, w is that along the direction of its centre.
    length, w = np.empty((2, len(uvw)))

    def measure(rows: slice) -> None:
        part = uvw[rows] * per_metre
        length[rows] = longest_seen(part, slope)
        w[rows] = np.abs(part[:, 2]) + slope * np.hypot(part[:, 0], part[:, 1])

    for _ in executor.map(measure, (slice(k, k + SLAB) for k in range(0, len(uvw), SLAB))):
        pass
    everything, flux = np.arange(len(galaxies)), largest_flux(galaxies, frequency)

    def octave(band: Band) -> _Octave:
        rows = np.flatnonzero(band.holds(length))
        if math.isinf(profile.extent):
            return _Octave(rows, band, (), everything)
        rows = rows[uv_order(uvw[rows])]
        reach = float(w[rows].max(initial=0.0))
        probes = uvw[rows[:: max(1, len(rows) // PROBES)]]
        # Multiples of the golden ratio spread over the band, whatever the order of the rows.
        place = np.arange(1, len(probes) + 1) * GOLDEN_RATIO % 1
        seen = frequency[(place * len(frequency)).astype(int)] / SPEED_OF_LIGHT
        errors = flux * relative_error(galaxies, probes * seen[:, None], profile)
        drawn = suited(errors, stamp_sizes(galaxies, band.pixel, profile), FOR_IMAGES * error)
        samples = len(rows) * len(frequency)
        cheapest = cheapest_side(galaxies.select(drawn), band, samples, reach, profile)
        if cheapest is None:
            return _Octave(rows, band, (), everything)
        side, costs = cheapest
        left = np.setdiff1d(everything, drawn)
        return _Octave(rows, band, _squares(galaxies, drawn, side), left, costs)

    yield from executor.map(octave, _octaves(length, galaxies))


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
