import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from uvshear.extraction.schedule import fitting_levels

SEPARATION = 0.1


@st.composite
def skies(draw):
    number = draw(st.integers(1, 40))
    coordinates = st.floats(-0.4, 0.4, allow_nan=False)
    lm = draw(arrays(float, (number, 2), elements=coordinates))
    flux = draw(arrays(float, number, elements=st.sampled_from([1.0, 2.0, 2.5, 7.0, 40.0])))
    return lm, flux


def _level_of(levels, number):
    level = np.full(number, -1)
    for value, members in enumerate(levels):
        level[members] = value
    return level


def _distance(lm):
    return np.hypot(*(lm[:, None] - lm[None]).transpose(2, 0, 1))


@given(skies())
def test_every_source_is_in_one_level(sky):
    levels = fitting_levels(*sky, SEPARATION)
    np.testing.assert_array_equal(np.sort(np.concatenate(levels)), np.arange(len(sky[0])))
    assert all(len(members) for members in levels)


@given(skies())
def test_no_two_of_a_level_are_neighbours(sky):
    lm, flux = sky
    distance = _distance(lm)
    for members in fitting_levels(lm, flux, SEPARATION):
        among = distance[np.ix_(members, members)] + np.diag(np.full(len(members), np.inf))
        assert np.all(among > SEPARATION * (1 - 1e-12))


@given(skies())
def test_every_brighter_neighbour_comes_earlier(sky):
    lm, flux = sky
    level = _level_of(fitting_levels(lm, flux, SEPARATION), len(flux))
    near = _distance(lm) < SEPARATION * (1 - 1e-12)
    brighter = flux[:, None] > flux[None]
    i, j = np.nonzero(near & brighter)
    assert np.all(level[i] < level[j])


@given(skies())
def test_a_source_waits_for_no_one_but_a_neighbour_of_the_level_before(sky):
    lm, flux = sky
    level = _level_of(fitting_levels(lm, flux, SEPARATION), len(flux))
    distance = _distance(lm)
    for source in np.flatnonzero(level > 0):
        before = level == level[source] - 1
        assert np.any(distance[source, before] <= SEPARATION * (1 + 1e-12))


@given(skies())
def test_a_level_is_in_decreasing_flux(sky):
    lm, flux = sky
    for members in fitting_levels(lm, flux, SEPARATION):
        assert np.all(np.diff(flux[members]) <= 0)


def test_isolated_sources_are_fitted_side_by_side_and_a_chain_one_by_one():
    far = np.column_stack([np.arange(5.0), np.zeros(5)])
    assert len(fitting_levels(far, np.ones(5), SEPARATION)) == 1
    chain = fitting_levels(far * 0.9 * SEPARATION, np.array([5.0, 4, 3, 2, 1]), SEPARATION)
    assert [members.tolist() for members in chain] == [[0], [1], [2], [3], [4]]


def test_no_sources_have_no_levels():
    assert fitting_levels(np.empty((0, 2)), np.empty(0), SEPARATION) == ()
