"""One visit of the visibilities: all models subtracted, the facets of all sources gathered from what is left.

In each band of baselines the models are drawn on tiles and predicted from there; the residual is imaged on the
same tiles. From the coarsest band on, images are refined and added to those of the next finer one; facets are cut
out of the finest. Nothing of this outlives the block of samples that it was made from: facets add up.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.extraction.converged.plan import VisitPlan
from uvshear.galaxy import Galaxies, Profile
from uvshear.imaging.bands import Band
from uvshear.imaging.interpolation import refined
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.tiles import Tile
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.rendering import render, stamp_size
from uvshear.predict.response import Response
from uvshear.typing import Array, Complex, Float

SLAB = 2**21
"""Samples that one call of the gridder takes; a matter of the data alone, so that sums do not depend on executor."""

BYTES_PER_SAMPLE = 160
"""What a sample takes while it is worked on: itself, its model, its baseline seen from two tiles."""

LEAST_BLOCK = 2**16
"""Samples held in memory at a time however little there is."""

Step = Callable[[float], None]
"""Hears how much work (samples times pixels of tiles, in any unit) is done."""


@dataclass(frozen=True)
class Gridding:
    """How the gridder is to work.

    Parameters
    ----------
    epsilon
        Its relative error.
    block
        Samples held in memory at a time.
    executor
        For tiles side by side.
    """

    epsilon: float = 1e-4
    block: int = 2**24
    executor: Executor = SERIAL


@dataclass(frozen=True)
class ModelledSky:
    """What is subtracted: galaxies, how far each matters [rad], how samples see them, and their profile."""

    galaxies: Galaxies
    half_width: Float[Array, " source"]
    response: Response
    profile: Profile


def block_of(memory: float) -> int:
    """Choose how many samples to hold where so much memory [bytes] may be used: a third is for them."""
    return max(int(memory / 3 / BYTES_PER_SAMPLE), LEAST_BLOCK)


def gather_residuals(
    observation: Observation,
    plan: VisitPlan,
    sky: ModelledSky,
    gridding: Gridding,
    step: Step | None = None,
) -> list[Complex[Array, " _"]]:
    """Facet of each source, with all models subtracted; centred where the plan says."""
    facets = [np.zeros(len(one.multiplicity), np.complex64) for one in plan.cutouts]
    for samples in blocks(observation, plan.shortest, plan.longest, gridding.block):
        _add_block(samples, plan, sky, gridding, facets, step)
    return [
        facet * one.recentring(tuple(offset))
        for facet, one, offset in zip(facets, plan.cutouts, plan.offset, strict=True)
    ]


def blocks(
    observation: Observation, shortest: float, longest: float, size: int
) -> Iterator[Samples]:
    """Give the samples of a range of uv distance [wavelengths], ``size`` at a time however they are read."""
    parts: list[Samples] = []
    held = 0
    for chunk in observation.chunks():
        part = Samples.of(chunk, shortest, longest)
        while held + len(part) >= size:
            first = size - held
            yield Samples.join([*parts, part.select(slice(first))])
            part, parts, held = part.select(slice(first, None)), [], 0
        if len(part):
            parts.append(part)
            held += len(part)
    if parts:
        yield Samples.join(parts)


def _add_block(
    samples: Samples,
    plan: VisitPlan,
    sky: ModelledSky,
    gridding: Gridding,
    facets: Sequence[Complex[Array, " _"]],
    step: Step | None,
) -> None:
    number = plan.band_of(samples.uv_distance)
    coarser: list[Float[Array, "l m"]] = []
    for b in range(len(plan.bands) - 1, plan.top - 1, -1):
        band, tiles = plan.bands[b], plan.tiles[b]
        part = samples.select(np.flatnonzero(number == b))
        weighted = _weighted_residual(part, tiles, band, sky, gridding)
        images = []
        for tile, image in zip(
            tiles, _images(part, weighted, tiles, band, sky.response, gridding), strict=True
        ):
            if tile.parent >= 0:
                above = plan.tiles[b + 1][tile.parent]
                (i, j), (k, l) = tile.origin, above.origin
                shift = i - 2 * k, j - 2 * l
                np.add(image, refined(coarser[tile.parent], shift, tile.size), out=image)
            if b == plan.top:
                _cut(image, tile, plan, facets, gridding.executor)
            else:
                images.append(image)
            if step is not None:
                step(work_of(len(part), tile))
        coarser = images


def work_of(samples: int, tile: Tile) -> float:
    """Cost of a tile, in nanoseconds or so."""
    return 700 * samples + 150 * tile.size**2


def _weighted_residual(
    samples: Samples,
    tiles: Sequence[Tile],
    band: Band,
    sky: ModelledSky,
    gridding: Gridding,
) -> Complex[Array, " sample"]:
    """Weight times what is left of each sample, with the common power law as matched filter."""
    model = predict_samples(samples, tiles, band, sky, gridding)
    gain = sky.response.gain(samples.frequency)
    return (samples.stokes_i - model) * (samples.weights * gain)


def predict_samples(
    samples: Samples,
    tiles: Sequence[Tile],
    band: Band,
    sky: ModelledSky,
    gridding: Gridding,
) -> Complex[Array, " sample"]:
    """Visibilities of the sky on samples of a band [Jy], by way of images on its tiles."""
    model = np.zeros(len(samples), np.complex64)
    response = sky.response

    def draw(part: _Part) -> Float[Array, "l m"]:
        members = part.tile.members
        return render(
            sky.galaxies.select(members),
            part.flux,
            sky.half_width[members],
            part.tile,
            band,
            sky.profile,
        )

    def predict(
        task: tuple[_Part, Float[Array, "l m"], slice],
    ) -> tuple[slice, Complex[Array, " slab"]]:
        part, image, rows = task
        plane = TangentPlane.at(samples.uvw[rows], *part.tile.centre(band.pixel))
        vis = plane.visibilities(image, band.pixel, gridding.epsilon)
        return rows, vis * response.source_factor(samples.select(rows), *part.seen_as)

    parts = [part for tile in tiles for part in _parts(_padded(tile, sky, band), sky, band)]
    drawn = zip(parts, gridding.executor.map(draw, parts), strict=True)
    tasks = ((part, image, rows) for part, image in drawn for rows in slabs(len(samples)))
    for rows, vis in gridding.executor.map(predict, tasks):
        model[rows] += vis
    return model * response.gain(samples.frequency)


@dataclass(frozen=True)
class _Part:
    """Fluxes of a tile's members [Jy] that samples see as they see a source at (l, m) of a spectral index."""

    tile: Tile
    flux: Float[Array, " member"]
    seen_as: tuple[float, float, float]


def _parts(tile: Tile, sky: ModelledSky, band: Band) -> list[_Part]:
    members = sky.galaxies.select(tile.members)
    shared = sky.response.shared_factors(members, band.shortest, band.longest)
    parts = []
    for source, coefficients in zip(shared.chosen.tolist(), shared.coefficients, strict=True):
        seen_as = (
            float(members.l[source]),
            float(members.m[source]),
            float(members.spectral_index[source]),
        )
        parts.append(_Part(tile, members.flux * coefficients, seen_as))
    return parts


def _padded(tile: Tile, sky: ModelledSky, band: Band) -> Tile:
    """Widen a tile so that the stamps of its members, at where these are now, are inside."""
    half = [stamp_size(float(x), band.pixel) // 2 + 1 for x in sky.half_width[tile.members]]
    low, high = [], []
    for x in (sky.galaxies.l, sky.galaxies.m):
        place = np.rint(x[tile.members] / band.pixel).astype(int)
        low.append(int((place - half).min()))
        high.append(int((place + half).max()))
    size = max(high[0] - low[0], high[1] - low[1])
    size += size % 2
    return Tile(tile.band, (low[0], low[1]), size, tile.members, tile.parent)


def _images(
    samples: Samples,
    weighted: Complex[Array, " sample"],
    tiles: Sequence[Tile],
    band: Band,
    response: Response,
    gridding: Gridding,
) -> Iterator[Float[Array, "l m"]]:
    """Image of each tile in turn, with what its centre sees as matched filter."""

    def image(task: tuple[Tile, slice]) -> Float[Array, "l m"]:
        tile, rows = task
        centre = tile.centre(band.pixel)
        filtered = weighted[rows] * response.matched_filter(samples.select(rows), *centre)
        plane = TangentPlane.at(samples.uvw[rows], *centre)
        return plane.image(filtered, tile.size, band.pixel, gridding.epsilon)

    parts_of_rows = slabs(len(samples))
    parts = gridding.executor.map(image, ((tile, rows) for tile in tiles for rows in parts_of_rows))
    for _ in tiles:
        total = next(parts)
        for _ in parts_of_rows[1:]:
            total += next(parts)
        yield total


def slabs(samples: int) -> list[slice]:
    """Divide samples into parts of at most ``SLAB``, as equal as can be."""
    count = max(1, -(-samples // SLAB))
    edges = [samples * k // count for k in range(count + 1)]
    return [slice(*pair) for pair in pairwise(edges)]


def _cut(
    image: Float[Array, "l m"],
    tile: Tile,
    plan: VisitPlan,
    facets: Sequence[Complex[Array, " _"]],
    executor: Executor,
) -> None:
    """Add the cutouts of a tile's members to their facets."""

    def add(source: int) -> None:
        one, facet = plan.cutouts[source], facets[source]
        size, place = one.size // 2**plan.top, plan.place[source] // 2**plan.top
        i, j = place - tile.origin - size // 2
        square = image[i : i + size, j : j + size]
        if plan.top == 0:
            facet += one.transform(square)
        else:
            one.add_coarse(square, 1.0, facet)

    for _ in executor.map(add, tile.members.tolist()):
        pass
