"""The size of the tiles."""

import numpy as np
import pytest

from tests.extraction.converged.test_tile_filters import _probes
from tests.skies import galaxies
from uvshear.extraction.converged.plan import FacetRequests
from uvshear.extraction.converged.tile_sizes import _span, fastest_tiling, work_of
from uvshear.imaging.bands import OVERSAMPLING
from uvshear.imaging.tiles import WIDEST, Tile
from uvshear.interferometer.attenuation import BandwidthSmearing
from uvshear.interferometer.summary import ObservationSummary
from uvshear.predict.response import Response

LONGEST = 1.5e5
COUNT = 25


def _tiling(attenuation, samples, half_width=3e-3):
    rng = np.random.default_rng(3)
    l, m = rng.uniform(-half_width, half_width, (2, COUNT))
    sky = galaxies(l, m, np.ones(COUNT))
    probes = _probes()
    requests = FacetRequests(l, m, np.full(COUNT, 2e-4), np.full(COUNT, LONGEST))
    summary = ObservationSummary(samples, samples, LONGEST, 1.5e9, 1.3e9, 1.0, probes)
    response = Response.from_sky(sky, probes, attenuation)
    return fastest_tiling(requests, (0.0, LONGEST, LONGEST), sky, response, summary, 1e-4)


def _parts(samples, half_width):
    """Number of equal parts into which the field is divided along a side."""
    # COUNT positions reach to within a few per cent of the edge.
    pixels = 2 * OVERSAMPLING * LONGEST * 2 * half_width
    parts = 0.95 * pixels / _tiling(None, samples, half_width).width
    assert parts == pytest.approx(round(parts), rel=0.05)
    return round(parts)


def test_tiles_are_large_where_sources_have_one_factor():
    assert _parts(10**7, half_width=4e-3) == 1
    assert _tiling(None, 10**7, half_width=4e-3).width <= WIDEST


def test_tiles_are_joined_in_coarse_bands_where_their_number_is_even():
    # Five parts of the largest core would be joined to three in the next band, and to two in the one after it.
    assert _parts(10**7, half_width=1.9e-2) == 4


def test_a_field_of_few_samples_is_divided_among_workers():
    assert _parts(10**5, half_width=3e-3) == 2
    # Every tile takes all samples.
    assert _parts(10**7, half_width=3e-3) == 1


def test_tiles_of_few_samples_are_joined_later():
    assert _tiling(None, 10**5).unjoined == 2
    assert _tiling(None, 10**7, half_width=1.9e-2).unjoined == 1


def test_the_time_of_workers_is_that_of_the_one_that_ends_last():
    assert _span([1.0, 2.0, 3.0, 4.0], 2) == 5.0
    assert _span([9.0, 1.0, 1.0], 2) == 9.0
    assert _span([1.5, 2.5], 1) == 4.0
    assert _span([], 2) == 0.0


def test_tiles_are_small_where_factors_vary_fast_and_samples_are_few():
    small = _tiling(BandwidthSmearing(), 10**5).width
    assert small <= WIDEST // 4
    assert _tiling(BandwidthSmearing(), 10**8).width >= small


def test_work_grows_with_samples_and_pixels():
    small, large = (Tile(0, (0, 0), size, np.zeros(1, int), -1) for size in (100, 1000))
    assert work_of(0, large) == 100 * work_of(0, small)
    assert work_of(2000, small) > work_of(1000, small)
