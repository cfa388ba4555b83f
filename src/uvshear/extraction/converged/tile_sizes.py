"""Size of the tiles, chosen so that the major cycles take the least time.

The factors of the sources of a tile (spectrum, smearing, primary beam) are linear combinations of the factors of a few
of these sources, and a tile is degridded and imaged once for each of the few. Where the factors vary fast over the
field, a large tile therefore needs many images and a small tile needs only one. However, every image takes all samples
of the band through the gridder, so that many small tiles are expensive, too. Small tiles have two other advantages: the
term w (n - 1) is a sum of a few products in them (``imaging.w_terms``), and several workers can share them.
"""

import heapq
import math
from collections.abc import Iterator, Sequence
from itertools import chain

import numpy as np

from uvshear.extraction.converged.plan import FacetRequests, MajorCyclePlan, plan_major_cycle
from uvshear.galaxy import Galaxies
from uvshear.imaging.bands import OVERSAMPLING, Band
from uvshear.imaging.grid import ImageGrid
from uvshear.imaging.tiles import WIDEST, Tile, Tiling
from uvshear.imaging.w_terms import number_of_terms
from uvshear.interferometer.summary import ObservationSummary
from uvshear.predict.gridded import slabs
from uvshear.predict.response import Response, SharedFactors
from uvshear.typing import Array, Float

NARROWEST = 96
"""Smallest width of a tile that is considered, without its margins, which are wider [pixels]."""

FEW_PROBES = 512
"""Number of samples from which the number of images that each tile needs is found."""

_SAMPLE, _SAMPLE_AND_RADIAN, _PIXEL, _PIXEL_AND_RADIAN = 500.0, 20.0, 230.0, 7.0
"""Costs of degridding and imaging a tile with w-planes, on one core [ns]: of a sample and of a pixel, without w and for
each radian of the phase that the largest w causes in the corner of the tile, for which there are further planes."""

_TERM_SAMPLE, _TERM_PIXEL = 130.0, 28.0
"""Costs of degridding and imaging a tile with one of the products that replace w-planes, on one core [ns]."""

_ELSEWHERE = 300.0
"""Cost of a sample of an image outside the gridder, on one core [ns]."""

_USUAL_PHASE = 15.0
"""Phase of the largest w in the corner of a tile, where it is not known [rad]."""

_ROUGH_CYCLES = 2
"""Assumed number of major cycles without the finest band; one cycle with it follows."""

_WORKERS = 2
"""Number of workers for which tiles are chosen, whatever their real number: results must not depend on it."""


def work_of(samples: int, tile: Tile, phase: float = _USUAL_PHASE) -> float:
    """Estimate the cost of degridding and imaging a tile once with w-planes, on one core [ns].

    ``phase`` is that of the largest w in the corner of the tile [rad].
    """
    for_pixels = (_PIXEL + _PIXEL_AND_RADIAN * phase) * tile.size**2
    return for_pixels + (_SAMPLE + _SAMPLE_AND_RADIAN * phase + _ELSEWHERE) * samples


def fastest_tiling(
    requests: FacetRequests,
    limits: tuple[float, float, float],
    galaxies: Galaxies,
    response: Response,
    summary: ObservationSummary,
    epsilon: float,
) -> Tiling:
    """Choose the tiles with which the major cycles take the least time.

    The choice depends on the data alone, so that results do not depend on the number of workers.

    Parameters
    ----------
    requests
        Facets of the sources.
    limits
        Shortest and longest baseline that are used, and the longest that pixels must represent [wavelengths].
    galaxies
        The sources.
    response
        Spectra and attenuations of the sources.
    summary
        Summary of the observation.
    epsilon
        Relative error of the gridder.
    """
    few = summary.probes.select(slice(FEW_PROBES))
    uvw = few.uvw.astype(float)
    factors = None if response.is_common(galaxies) else response.factors(few, galaxies)

    def seconds(tiling: Tiling) -> float:
        plan = plan_major_cycle(requests, *limits, tiling=tiling, baselines=uvw)
        return _time_of_plan(plan, factors, uvw, summary.samples, epsilon)

    return min(_tilings(requests, limits, is_common=factors is None), key=seconds)


def _tilings(
    requests: FacetRequests, limits: tuple[float, float, float], *, is_common: bool
) -> Iterator[Tiling]:
    """Yield tilings that divide the field into equal parts, from the largest tiles down."""
    _, longest, finest = limits
    extent = max(float(np.ptp(x)) for x in (requests.l, requests.m))
    pixels = 2 * OVERSAMPLING * max(longest, finest) * extent
    fewest = max(1, math.ceil(pixels / (WIDEST - 1)))
    parts, most = fewest, 2 * fewest if is_common else math.ceil(pixels / NARROWEST)
    while parts <= max(most, fewest):
        for unjoined in (1, 2) if parts > 1 else (1,):
            yield Tiling(math.floor(pixels / parts) + 1, unjoined)
        parts = parts + 1 if is_common else 2 * parts


def _time_of_plan(
    plan: MajorCyclePlan,
    factors: Float[Array, "probe source"] | None,
    uvw: Float[Array, "probe 3"],
    samples: int,
    epsilon: float,
) -> float:
    """Estimate the time of all major cycles with ``_WORKERS`` workers [ns]."""
    finest, *coarser = tasks_of_bands(plan, factors, uvw, samples, epsilon)
    others = list(chain.from_iterable(coarser))
    rough = others or finest
    return _ROUGH_CYCLES * _span(rough, _WORKERS) + _span(finest + others, _WORKERS)


def tasks_of_bands(
    plan: MajorCyclePlan,
    factors: Float[Array, "probe source"] | None,
    uvw: Float[Array, "probe 3"],
    samples: int,
    epsilon: float,
) -> list[list[float]]:
    """Estimate the cost of each task of a major cycle, on one core [ns]; there is a list for each band.

    Parameters
    ----------
    plan
        Plan of a major cycle.
    factors
        Factors of all sources for the probes; None where all sources have the same.
    uvw
        Baselines of the probes [wavelengths].
    samples
        Number of samples of the observation.
    epsilon
        Relative error of the gridder.
    """
    distance = np.hypot(uvw[:, 0], uvw[:, 1])
    of_bands = []
    for band, tiles in zip(plan.bands, plan.tiles, strict=True):
        inside = band.holds(distance)
        in_band = math.ceil(samples * float(np.mean(inside)))
        # Few probes in a band would not tell how much factors differ.
        enough = np.count_nonzero(inside) >= max(1, len(uvw) // 8)
        seen = factors[inside] if factors is not None and enough else factors
        of_band: list[float] = []
        for tile in tiles:
            images = 1
            if seen is not None:
                images = len(SharedFactors.from_factors(seen[:, tile.members]).chosen)
            of_band += images * _tasks_of_image(in_band, tile, band, uvw[inside, 2], epsilon)
        of_bands.append(of_band)
    return of_bands


def _tasks_of_image(
    samples: int, tile: Tile, band: Band, w: Float[Array, " probe"], epsilon: float
) -> list[float]:
    """Return the cost of each task of an image, on one core [ns], for samples with a few of which w is given."""
    phase = 2 * math.pi * float(np.abs(w).max(initial=0.0)) * (tile.size * band.pixel / 2) ** 2
    tasks = []
    for slab in slabs(samples):
        count = slab.stop - slab.start
        work = work_of(count, tile, phase)
        image = ImageGrid(tile.size, band.pixel)
        if (terms := number_of_terms(w, image, epsilon, count)) is not None:
            of_term = _TERM_PIXEL * tile.size**2 + _TERM_SAMPLE * count
            work = terms * of_term + _ELSEWHERE * count
        tasks.append(work)
    return tasks


def _span(works: Sequence[float], workers: int) -> float:
    """Return the time that workers take, each of which begins with the longest task that is left."""
    free = [0.0] * workers
    for work in sorted(works, reverse=True):
        heapq.heapreplace(free, free[0] + work)
    return max(free)
