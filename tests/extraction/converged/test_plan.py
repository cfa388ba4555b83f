import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uvshear.extraction.converged.plan import LADDER, FacetRequests, plan_major_cycle

LONGEST = 5.5e4
PIXEL = 1 / (2.4 * LONGEST)


def _requests(seed=1, sources=12, span=1800):
    rng = np.random.default_rng(seed)
    lm = rng.uniform(-0.5, 0.5, (2, sources)) * span * PIXEL + 0.004
    width = rng.uniform(30, 120, sources) * PIXEL
    return FacetRequests(*lm, width, rng.uniform(0.3, 1.5, sources) * LONGEST)


any_requests = st.builds(
    _requests, st.integers(0, 999), st.integers(1, 15), st.sampled_from([0.0, 100.0, 1800.0])
)
quickly = settings(deadline=None, max_examples=25)


@quickly
@given(any_requests)
def test_a_cutout_is_on_an_even_place_within_a_pixel_of_its_source(requests):
    plan = plan_major_cycle(requests, 0.0, LONGEST)
    assert plan.pixel == pytest.approx(PIXEL)
    assert np.all(plan.place % 2 == 0)
    assert np.all(np.abs(plan.offset) <= PIXEL * (1 + 1e-9))
    lm = np.column_stack([requests.l, requests.m])
    np.testing.assert_allclose(plan.place * PIXEL + plan.offset, lm, rtol=0, atol=1e-15)


@quickly
@given(any_requests)
def test_a_cutout_is_as_wide_and_reaches_as_far_as_is_wanted_and_little_more(requests):
    plan = plan_major_cycle(requests, 100.0, LONGEST)
    for cutout, width, uv_max in zip(
        plan.cutouts, requests.width, requests.informative_uv_max, strict=True
    ):
        assert cutout.pixel == plan.pixel
        assert cutout.shortest == 100.0
        assert width / PIXEL * (1 - 1e-9) <= cutout.size <= 1.5 * width / PIXEL + 8
        reach = min(uv_max, LONGEST)
        assert reach * (1 - 1e-9) <= cutout.longest <= reach * LADDER * (1 + 1e-9)
        assert cutout.longest <= LONGEST


@quickly
@given(any_requests)
def test_every_square_is_inside_its_tile_of_the_finest_band(requests):
    plan = plan_major_cycle(requests, 0.0, LONGEST)
    for tile in plan.tiles[0]:
        for source in tile.members:
            first = plan.place[source] - tile.origin - plan.cutouts[source].size // 2
            assert np.all(first >= 0)
            assert np.all(first + plan.cutouts[source].size <= tile.size)


def test_sources_of_about_one_size_share_their_cutout():
    requests = _requests(sources=3)
    alike = FacetRequests(
        requests.l, requests.m, np.array([70.0, 70.5, 110.0]) * PIXEL, np.full(3, 0.9 * LONGEST)
    )
    cutouts = plan_major_cycle(alike, 0.0, LONGEST).cutouts
    assert cutouts[0] is cutouts[1]
    assert cutouts[0] != cutouts[2]


@settings(deadline=None)
@given(st.lists(st.floats(0.0, 1.0, exclude_max=True), min_size=1, max_size=20))
def test_the_number_of_a_samples_band_is_that_of_the_band_that_holds_it(parts):
    plan = plan_major_cycle(_requests(span=6000), 50.0, LONGEST)
    assert len(plan.bands) == 4
    edges = [band.shortest for band in plan.bands]
    distance = np.array([*(50.0 + np.array(parts) * (LONGEST - 50.0)), *edges])
    for x, number in zip(distance, plan.band_of(np.outer(distance, [1, 0, 0])), strict=True):
        holding = [b for b, band in enumerate(plan.bands) if band.holds(np.array([x]))[0]]
        assert holding == [number]


def test_a_field_of_one_source_is_one_tile():
    plan = plan_major_cycle(_requests(sources=1), 0.0, LONGEST)
    assert len(plan.bands) == 1
    assert [len(tiles) for tiles in plan.tiles] == [1]
