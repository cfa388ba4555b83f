from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.skies import random_baselines
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Visibilities

FREQUENCY = np.array([1.0e9, 1.3e9, 1.5e9])


def _block(rows=40, seed=2):
    rng = np.random.default_rng(seed)
    vis = rng.normal(size=(2, rows, 3))
    weights = rng.uniform(0.5, 2, (rows, 3)) * (rng.uniform(size=(rows, 3)) > 0.3)
    uvw = random_baselines(rows, 3e3, seed=seed)
    return Visibilities(uvw, FREQUENCY, vis[0] + 1j * vis[1], weights)


def _one_by_one(block, shortest, longest):
    """(u, v, w, vis, weight, frequency) of each sample kept, by a loop."""
    kept = []
    for row in range(len(block)):
        for chan, nu in enumerate(block.frequency):
            u, v, w = block.uvw[row] * nu / SPEED_OF_LIGHT
            weight = block.weights[row, chan]
            if weight > 0 and shortest <= np.hypot(u, v) < longest:
                kept.append((u, v, w, block.stokes_i[row, chan], weight, nu))
    return kept


def test_samples_are_the_visibilities_with_weight_within_the_range_of_uv_distance():
    block = _block()
    samples = Samples.from_visibilities(block, 2e3, 9e3)
    u, v, w, vis, weights, frequency = map(
        np.array, zip(*_one_by_one(block, 2e3, 9e3), strict=True)
    )
    assert 10 < len(samples) < 100
    np.testing.assert_allclose(samples.uvw, np.column_stack([u, v, w]), rtol=1e-14)
    np.testing.assert_allclose(samples.stokes_i, vis, rtol=2e-7)  # single precision: 6e-8
    np.testing.assert_allclose(samples.weights, weights, rtol=2e-7)
    np.testing.assert_array_equal(samples.frequency, frequency)
    np.testing.assert_allclose(samples.uv_distance, np.hypot(u, v), rtol=1e-14)


@settings(deadline=None)
@given(st.lists(st.floats(1.0, 2e4), min_size=1, max_size=5, unique=True))
def test_neighbouring_ranges_share_no_sample_and_lose_none(edges):
    block = _block()
    # an edge exactly on a sample belongs to the range above it
    edges = [0.0, *sorted([*edges, float(block.uv_distance[3, 1])]), np.inf]
    counts = [len(Samples.from_visibilities(block, *pair)) for pair in pairwise(edges)]
    assert sum(counts) == np.count_nonzero(block.weights)


@settings(deadline=None, max_examples=30)
@given(st.lists(st.integers(0, 60), max_size=4))
def test_parts_joined_are_the_whole(cuts):
    whole = Samples.from_visibilities(_block(), 0.0, np.inf)
    edges = [0, *sorted(min(cut, len(whole)) for cut in cuts), len(whole)]
    parts = [whole.select(slice(*pair)) for pair in pairwise(edges)]
    joined = Samples.join(parts)
    for name in ("uvw", "stokes_i", "weights", "frequency"):
        np.testing.assert_array_equal(getattr(joined, name), getattr(whole, name))


def test_samples_are_selected_by_index_and_by_mask():
    whole = Samples.from_visibilities(_block(), 0.0, np.inf)
    mask = np.arange(len(whole)) % 3 == 0
    for chosen in (mask, np.flatnonzero(mask)):
        some = whole.select(chosen)
        np.testing.assert_array_equal(some.uvw, whole.uvw[::3])
        np.testing.assert_array_equal(some.frequency, whole.frequency[::3])
