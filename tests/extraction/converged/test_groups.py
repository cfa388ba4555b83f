import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from uvshear.constants import ARCSEC
from uvshear.extraction.converged.groups import MOST_MEMBERS, OVERLAP, overlapping_groups

SIZE = 2 * ARCSEC
TOUCH = 2 * OVERLAP * SIZE
"""Distance at which two of one size begin to overlap."""


def _chain(*gaps):
    """Sources along a line, ``gaps`` in units of the distance at which two overlap."""
    x = np.concatenate([[0.0], np.cumsum(gaps)]) * TOUCH
    return np.column_stack([x, np.zeros(len(x))]), np.full(len(x), SIZE)


@settings(deadline=None)
@given(st.integers(0, 9999), st.integers(1, 40), st.floats(1.0, 30.0))
def test_every_source_is_in_exactly_one_group(seed, sources, width):
    rng = np.random.default_rng(seed)
    place = rng.uniform(0, width * TOUCH, (sources, 2))
    groups = overlapping_groups(place, rng.uniform(0.3, 1, sources) * SIZE)
    assert sorted(source for group in groups for source in group) == list(range(sources))
    assert groups == sorted(sorted(group) for group in groups)
    assert max(len(group) for group in groups) <= MOST_MEMBERS


@settings(deadline=None)
@given(st.integers(0, 9999), st.integers(2, 12))
def test_groups_are_the_connected_sets_of_overlaps_where_none_is_too_large(seed, sources):
    rng = np.random.default_rng(seed)
    place = rng.uniform(0, 5 * TOUCH, (sources, 2))
    size = rng.uniform(0.3, 1, sources) * SIZE
    group = list(range(sources))  # by repainting, the slow obvious way
    for i in range(sources):
        for j in range(sources):
            apart = np.hypot(*(place[i] - place[j]))
            if apart < OVERLAP * (size[i] + size[j]):
                group = [group[i] if g == group[j] else g for g in group]
    expected = sorted([k for k in range(sources) if group[k] == g] for g in set(group))
    if max(map(len, expected)) <= MOST_MEMBERS:
        assert overlapping_groups(place, size) == expected


def test_two_overlap_below_a_multiple_of_the_sum_of_their_sizes():
    assert overlapping_groups(*_chain(0.99)) == [[0, 1]]
    assert overlapping_groups(*_chain(1.01)) == [[0], [1]]


def test_neighbours_of_neighbours_share_a_group():
    assert overlapping_groups(*_chain(0.9, 0.9, 1.5, 0.5)) == [[0, 1, 2], [3, 4]]


def test_where_a_group_would_be_too_large_the_closest_stay_together():
    gaps = [0.8] + [0.3] * (MOST_MEMBERS - 1) + [0.8]
    groups = overlapping_groups(*_chain(*gaps))
    # in the order of the catalogue the first six would be one
    assert groups == [[0], list(range(1, MOST_MEMBERS + 1)), [MOST_MEMBERS + 1]]


def test_large_sources_overlap_at_larger_distances():
    place, size = _chain(1.4)
    assert overlapping_groups(place, size * np.array([1.0, 2.0])) == [[0, 1]]


def test_points_at_one_place_are_a_group():
    place = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    assert overlapping_groups(place, np.zeros(3)) == [[0, 1], [2]]
