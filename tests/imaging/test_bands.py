from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uvshear.imaging.bands import FEWEST_PIXELS, MOST_BANDS, octaves

LONGEST = 2e5

fields = st.tuples(st.floats(0.0, 0.9), st.floats(1e3, 1e6), st.floats(1e-5, 0.1)).map(
    lambda x: (x[0] * x[1], x[1], x[2])
)


@settings(deadline=None)
@given(fields, st.floats(0.0, 1.0, exclude_max=True))
def test_every_baseline_of_the_range_is_in_exactly_one_band(field, part):
    shortest, longest, width = field
    bands = octaves(shortest, longest, width)
    edges = [x for band in bands for x in (band.shortest, band.longest)]
    distance = np.array([shortest + part * (longest - shortest), *edges])
    distance = distance[(distance >= shortest) & (distance < longest)]
    held = sum(band.holds(distance).astype(int) for band in bands)
    np.testing.assert_array_equal(held, 1)
    assert not any(band.holds(np.array([longest])).any() for band in bands)


@settings(deadline=None)
@given(fields)
def test_bands_fall_from_the_longest_baseline_and_each_doubles_the_pixel(field):
    shortest, longest, width = field
    bands = octaves(shortest, longest, width)
    assert bands[0].longest == longest
    assert bands[-1].shortest == shortest
    assert 1 <= len(bands) <= MOST_BANDS
    for fine, coarse in pairwise(bands):
        assert coarse.pixel == 2 * fine.pixel
        assert coarse.longest == fine.shortest
    assert all(band.longest > band.shortest for band in bands)


@settings(deadline=None)
@given(fields)
def test_pixels_oversample_a_fifth_and_those_to_be_interpolated_three_fifths(field):
    bands = octaves(*field)
    assert 0.5 / bands[0].pixel == pytest.approx(1.2 * bands[0].longest, rel=1e-12)
    for band in bands[1:]:
        # less, and the interpolation between bands, good to 2e-5 at 1.6, would not be
        assert 0.5 / band.pixel == pytest.approx(1.6 * band.longest, rel=1e-12)


@settings(deadline=None)
@given(fields)
def test_no_band_has_an_image_smaller_than_worth_while_but_the_only_one(field):
    bands = octaves(*field)
    assert len(bands) == 1 or field[2] / bands[-2].pixel >= FEWEST_PIXELS


def test_a_wide_field_has_all_bands_and_a_narrow_one_a_single_band():
    pixel = 1 / (2.4 * LONGEST)
    assert len(octaves(0.0, LONGEST, 10_000 * pixel)) == MOST_BANDS
    assert len(octaves(0.0, LONGEST, 500 * pixel)) == 1


def test_there_is_no_band_below_the_shortest_baseline():
    pixel = 1 / (2.4 * LONGEST)
    assert len(octaves(0.5 * LONGEST, LONGEST, 10_000 * pixel)) == 1
