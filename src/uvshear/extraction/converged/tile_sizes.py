"""Sizes of the tiles: small where the factors of sources vary fast, and as large as w allows elsewhere.

A tile is degridded and imaged once for each of the few factors of which those of its sources are combinations. Where
smearing or a primary beam varies fast, a large tile needs many images; many small tiles need one image each, but every
image takes all samples.
"""

import math
from collections.abc import Iterator

import numpy as np

from uvshear.extraction.converged.plan import FacetRequests, MajorCyclePlan, plan_major_cycle
from uvshear.galaxy import Galaxies
from uvshear.imaging.bands import OVERSAMPLING
from uvshear.imaging.tiles import CORE, Tile
from uvshear.interferometer.summary import ObservationSummary
from uvshear.predict.gridded import SLAB
from uvshear.predict.response import Response, SharedFactors
from uvshear.typing import Array, Float

SMALLEST_CORE = 96
"""Smallest core of a tile that is considered [pixels]; the margins for the facets of its sources are wider."""

FEW_PROBES = 512
"""Number of samples on which the numbers of images are counted."""

_SAMPLE, _PIXEL, _PIXEL_AND_RADIAN = 1000.0, 90.0, 3.5
"""Costs of degridding and imaging a tile once, on one core [ns]: of a sample, of a pixel, and of a pixel for each
radian of the phase that the largest w causes in the corner of the tile, for which the gridder needs further planes."""

_USUAL_PHASE = 15.0
"""Phase in the corner of a tile [rad]."""

_CYCLES = 3
"""Number of major cycles, of which the finest band is used in the last one alone."""


def work_of(samples: int, tile: Tile, phase: float = _USUAL_PHASE) -> float:
    """Estimate the cost of degridding and imaging a tile once [nanoseconds].

    ``phase`` is that of the largest w in the corner of the tile [rad].
    """
    return _SAMPLE * samples + (_PIXEL + _PIXEL_AND_RADIAN * phase) * tile.size**2


def cheapest_core(
    requests: FacetRequests,
    baselines: tuple[float, float, float],
    galaxies: Galaxies,
    response: Response,
    summary: ObservationSummary,
) -> int:
    """Choose the core of the tiles with which the major cycles take the least work [pixels].

    It depends on the data alone, as do all sums.

    Parameters
    ----------
    requests
        Facets of the sources.
    baselines
        Shortest and longest baseline that are used, and the longest that pixels must represent [wavelengths].
    galaxies
        The sources.
    response
        Spectra and attenuations of the sources.
    summary
        Summary of the observation.
    """
    few = summary.probes.select(slice(FEW_PROBES))
    uvw = few.uvw.astype(float)
    factors = None if response.is_common(galaxies) else response.factors(few, galaxies)
    plans = {
        core: plan_major_cycle(requests, *baselines, core=core, baselines=uvw)
        for core in _cores(requests, baselines, is_common=factors is None)
    }
    if factors is None and summary.samples <= SLAB:
        # A single task in the finest band would leave all workers but one without any. A field of 12 arcmin with 0.6
        # million samples takes as long on four tiles as on one. Slabs of more samples are tasks of their own.
        several = {core: plan for core, plan in plans.items() if len(plan.tiles[0]) > 1}
        plans = several or plans
    return min(plans, key=lambda core: _work_of_plan(plans[core], factors, uvw, summary.samples))


def _cores(
    requests: FacetRequests, baselines: tuple[float, float, float], *, is_common: bool
) -> Iterator[int]:
    """Yield cores that divide the field into equal parts, from the largest down."""
    _, longest, finest = baselines
    extent = max(float(np.ptp(x)) for x in (requests.l, requests.m))
    pixels = 2 * OVERSAMPLING * max(longest, finest) * extent
    fewest = max(1, math.ceil(pixels / (CORE - 1)))
    parts, most = fewest, 2 * fewest if is_common else math.ceil(pixels / SMALLEST_CORE)
    while parts <= max(most, fewest):
        yield math.floor(pixels / parts) + 1
        parts = parts + 1 if is_common else 2 * parts


def _work_of_plan(
    plan: MajorCyclePlan,
    factors: Float[Array, "probe source"] | None,
    uvw: Float[Array, "probe 3"],
    samples: int,
) -> float:
    total = 0.0
    distance, w = np.hypot(uvw[:, 0], uvw[:, 1]), np.abs(uvw[:, 2])
    for number, (band, tiles) in enumerate(zip(plan.bands, plan.tiles, strict=True)):
        inside = band.holds(distance)
        in_band = math.ceil(samples * float(np.mean(inside)))
        turn = 2 * math.pi * float(w[inside].max(initial=0.0))
        for tile in tiles:
            images = 1
            if factors is not None:
                seen = (
                    factors[inside]
                    if np.count_nonzero(inside) >= max(1, len(factors) // 8)
                    else factors
                )
                images = len(SharedFactors.from_factors(seen[:, tile.members]).chosen)
            phase = turn * (tile.size * band.pixel / 2) ** 2
            work = images * work_of(in_band, tile, phase)
            total += work * (_CYCLES if number else 1)
    return total
