from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from uvshear.imaging.interpolation import add_refined
from uvshear.imaging.tiles import TAPS, Footprint, Tiling, plan_tiles

PIXEL = 2e-6


def _footprint(seed, sources, span):
    """``sources`` over a square of ``span`` pixels somewhere in the sky, facets of 10 to 60 pixels."""
    rng = np.random.default_rng(seed)
    l, m = (rng.uniform(-3e3, 3e3, 2)[:, None] + span * rng.uniform(size=(2, sources))) * PIXEL
    return Footprint(l, m, rng.uniform(5, 30, sources) * PIXEL)


TILING = Tiling(300)
"""Tiles of 300 pixels: many of them, none large."""

footprints = st.builds(
    _footprint, st.integers(0, 999), st.integers(1, 40), st.sampled_from([0.0, 50.0, 900.0, 2500.0])
)
limits = st.one_of(
    st.none(),
    st.lists(st.sampled_from([20.0, 70.0, 400.0, np.inf]), min_size=4, max_size=4).map(
        lambda pixels: [half * PIXEL for half in pixels]
    ),
)
"""Half of the widths that the tiles of four bands may have."""


unjoined = st.integers(1, 4)


def _plan(footprint, bands, limit, unjoined):
    return plan_tiles(footprint, PIXEL, bands, Tiling(300, unjoined), limit and limit[:bands])


quickly = settings(deadline=None, max_examples=25)


@quickly
@given(footprints, st.integers(1, 4), limits, unjoined)
def test_every_source_is_in_exactly_one_tile_of_each_band(footprint, bands, limit, unjoined):
    plan = _plan(footprint, bands, limit, unjoined)
    assert len(plan) == bands
    for tiles in plan:
        members = np.concatenate([tile.members for tile in tiles])
        np.testing.assert_array_equal(np.sort(members), np.arange(len(footprint.l)))
        assert all(len(tile.members) for tile in tiles)


@quickly
@given(footprints, st.integers(1, 4), limits, unjoined)
def test_every_facet_is_inside_its_tile_in_every_band(footprint, bands, limit, unjoined):
    for band, tiles in enumerate(_plan(footprint, bands, limit, unjoined)):
        step = PIXEL * 2**band
        for tile in tiles:
            half = footprint.half_width[tile.members]
            for axis, x in enumerate((footprint.l, footprint.m)):
                place = x[tile.members]
                assert np.all(place - half >= tile.origin[axis] * step)
                assert np.all(place + half <= (tile.origin[axis] + tile.size - 1) * step)


@quickly
@given(footprints, st.integers(2, 4), limits, unjoined)
def test_a_parent_covers_its_children_and_what_interpolation_reaches_beyond(
    footprint, bands, limit, unjoined
):
    plan = _plan(footprint, bands, limit, unjoined)
    assert all(tile.parent == -1 for tile in plan[-1])
    for fine, coarse in pairwise(plan):
        for tile in fine:
            parent = coarse[tile.parent]
            assert set(tile.members) <= set(parent.members)
            for axis in (0, 1):
                first = (tile.origin[axis] - 2 * parent.origin[axis]) / 2
                last = first + (tile.size - 1) / 2
                assert first >= TAPS - 0.5  # a windowed sinc of 2 TAPS taps: TAPS - 1 below
                assert last <= parent.size - 1 - TAPS


def test_a_parent_can_be_refined_onto_every_child():
    footprint = _footprint(5, 30, 900.0)
    fine, coarse = plan_tiles(footprint, PIXEL, 2, TILING)
    assert len(fine) > len(coarse) > 1
    for tile in fine:
        above = coarse[tile.parent]
        shift = tile.origin[0] - 2 * above.origin[0], tile.origin[1] - 2 * above.origin[1]
        image = np.zeros((tile.size, tile.size), np.float32)
        add_refined(image, np.ones((above.size, above.size), np.float32), shift)
        assert image.shape == (tile.size, tile.size)  # one that is not covered raises


@quickly
@given(footprints, st.integers(1, 4))
def test_all_tiles_lie_on_one_lattice(footprint, bands):
    for band, tiles in enumerate(plan_tiles(footprint, PIXEL, bands, TILING)):
        for tile in tiles:
            assert tile.band == band
            assert tile.size % 2 == 0
            # of the finest pixels a tile's centre is a whole number, a multiple of the band's own pixel
            centre = np.array(tile.centre(PIXEL * 2**band)) / PIXEL / 2**band
            np.testing.assert_allclose(centre, np.rint(centre), rtol=0, atol=1e-9)
            np.testing.assert_array_equal(np.rint(centre), np.array(tile.origin) + tile.size // 2)


@quickly
@given(footprints, unjoined)
def test_tiles_are_joined_beyond_the_bands_that_divide_the_field_alike(footprint, unjoined):
    plan = _plan(footprint, 4, None, unjoined)
    for band, fine in enumerate(plan[:-1], start=1):
        of_parent = np.bincount([tile.parent for tile in fine])
        assert of_parent.max() <= (1 if band < unjoined else 4)


@quickly
@given(footprints)
def test_a_tile_is_no_wider_than_its_core_with_the_facets_at_its_edges(footprint):
    (tiles,) = plan_tiles(footprint, PIXEL, 1, TILING)
    for tile in tiles:
        for x in (footprint.l, footprint.m):
            assert np.ptp(x[tile.members]) <= 300.0001 * PIXEL
        assert tile.size <= 300 + 60 + 8


@quickly
@given(footprints, st.integers(1, 4), limits.filter(bool), unjoined)
def test_no_tile_is_wider_than_the_limit_of_its_band(footprint, bands, limit, unjoined):
    for band, tiles in enumerate(_plan(footprint, bands, limit, unjoined)):
        for tile in tiles:
            for x in (footprint.l, footprint.m):
                assert np.ptp(x[tile.members]) <= 2.0001 * limit[band]


def test_the_sources_of_a_tile_are_about_its_centre():
    l, m = np.array([-140.0, 0.0, 140.0]) * PIXEL, np.full(3, 5000.0) * PIXEL
    ((tile,),) = plan_tiles(Footprint(l, m, np.full(3, 10 * PIXEL)), PIXEL, 1)
    np.testing.assert_allclose(tile.centre(PIXEL), (l[1], m[1]), atol=2 * PIXEL)


def test_only_places_with_sources_have_tiles():
    l = np.array([0.0, 3000.0]) * PIXEL
    footprint = Footprint(l, l, np.full(2, 10 * PIXEL))
    (tiles,) = plan_tiles(footprint, PIXEL, 1, TILING)
    assert len(tiles) == 2  # of a hundred boxes
