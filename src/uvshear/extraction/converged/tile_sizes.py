"""Sizes of the tiles: small where the factors of sources vary fast.

A tile is degridded and imaged once for each of the few factors of which those of its sources are combinations. Where
smearing or a primary beam varies fast, a large tile needs many images; many small tiles need one image each, but every
image takes all samples.
"""

import math

import numpy as np

from uvshear.extraction.converged.plan import FacetRequests, MajorCyclePlan, plan_major_cycle
from uvshear.galaxy import Galaxies
from uvshear.imaging.tiles import CORE, Tile
from uvshear.interferometer.summary import ObservationSummary
from uvshear.predict.gridded import SLAB
from uvshear.predict.response import Response, SharedFactors
from uvshear.typing import Array, Float

SMALLEST_CORE = 96
"""Smallest core of a tile that is considered [pixels]; the margins for the facets of its sources are wider."""

FEW_PROBES = 512
"""Number of samples on which the numbers of images are counted."""


def work_of(samples: int, tile: Tile) -> float:
    """Estimate the cost of degridding and imaging a tile once [nanoseconds]."""
    return 700 * samples + 150 * tile.size**2


def cheapest_core(
    requests: FacetRequests,
    baselines: tuple[float, float, float],
    galaxies: Galaxies,
    response: Response,
    summary: ObservationSummary,
) -> int:
    """Choose the core of the tiles with which a major cycle takes the least work [pixels].

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
    if response.is_common(galaxies):
        return _core_for_workers(requests, baselines, summary)
    few = summary.probes.select(slice(FEW_PROBES))
    factors = response.factors(few, galaxies)
    cores = [CORE]
    while cores[-1] // 2 >= SMALLEST_CORE:
        cores.append(cores[-1] // 2)

    def work(core: int) -> float:
        plan = plan_major_cycle(requests, *baselines, core=core, baselines=few.uvw.astype(float))
        return _work_of_plan(plan, factors, few.uv_distance, summary.samples)

    return min(cores, key=work)


def _core_for_workers(
    requests: FacetRequests, baselines: tuple[float, float, float], summary: ObservationSummary
) -> int:
    """Choose a smaller core where the finest band would be a single task for one worker.

    It depends on the data alone, as do all sums. A field of 12 arcmin with 0.6 million samples takes as long on four
    tiles as on one. With more samples, slabs of them are tasks of their own.
    """
    if summary.samples > SLAB:
        return CORE
    few = summary.probes.select(slice(FEW_PROBES)).uvw.astype(float)
    plan = plan_major_cycle(requests, *baselines, core=CORE, baselines=few)
    return CORE if len(plan.tiles[0]) > 1 else CORE // 2


def _work_of_plan(
    plan: MajorCyclePlan,
    factors: Float[Array, "probe source"],
    distance: Float[Array, " probe"],
    samples: int,
) -> float:
    total = 0.0
    for band, tiles in zip(plan.bands, plan.tiles, strict=True):
        inside = band.holds(distance)
        number = math.ceil(samples * float(np.mean(inside)))
        seen = factors[inside] if np.count_nonzero(inside) >= len(factors) // 8 else factors
        for tile in tiles:
            images = len(SharedFactors.from_factors(seen[:, tile.members]).chosen)
            total += images * work_of(number, tile)
    return total
