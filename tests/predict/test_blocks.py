"""Samples collected into blocks, however an observation is read."""

import weakref

import numpy as np
import pytest

from tests.skies import L_BAND, random_baselines
from uvshear.execution import in_threads
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict import blocks
from uvshear.predict.blocks import BlockAccumulator
from uvshear.predict.gridded import Gridding

ROWS = 1500
LONGEST = 3e4


class Collector(BlockAccumulator[list[Samples]]):
    """Keeps every block."""

    def __init__(self, size):
        super().__init__(0.0, LONGEST, Gridding(block=size, executor=in_threads(2)))
        self.blocks = []

    def add_block(self, samples):
        self.blocks.append(samples)

    def add_sums(self, later):
        self.blocks += later.blocks

    def total(self):
        return self.blocks


@pytest.fixture(scope="module")
def seen():
    uvw = random_baselines(ROWS, 7e3)
    vis = np.random.default_rng(1).normal(size=(ROWS, 2)) @ np.array([[1.0], [1j]])
    weights = np.ones((ROWS, 1))
    weights[::40] = 0
    return Visibilities(uvw, L_BAND, vis, weights)


def _in_pieces(seen, pieces):
    parts = np.array_split(np.arange(ROWS), pieces)
    return VisibilitySet(
        PhaseCentre(0.0, 0.0),
        tuple(
            Visibilities(seen.uvw[p], seen.frequency, seen.stokes_i[p], seen.weights[p])
            for p in parts
        ),
    )


@pytest.mark.parametrize("size", [7, 137, 1500, 10_000])
@pytest.mark.parametrize("pieces", [1, 25])
def test_blocks_are_of_the_size_asked_for_but_the_last(seen, size, pieces, monkeypatch):
    monkeypatch.setattr(blocks, "_AT_A_TIME", 64)
    (held,) = accumulate(_in_pieces(seen, pieces), [Collector(size)])
    assert all(len(block) == size for block in held[:-1])
    assert 0 < len(held[-1]) <= size
    joined, whole = Samples.join(held), Samples.from_visibilities(seen, 0.0, LONGEST)
    assert len(whole) < ROWS
    np.testing.assert_array_equal(joined.uvw, whole.uvw)
    np.testing.assert_array_equal(joined.stokes_i, whole.stokes_i)


def test_no_sample_is_lost_or_taken_twice_where_a_pass_was_divided(seen):
    parts = _in_pieces(seen, 2).blocks
    first, later = Collector(400), Collector(400)
    first.add(parts[0])
    later.add(parts[1])
    first.merge(later)
    joined = Samples.join(first.result())
    whole = Samples.from_visibilities(seen, 0.0, LONGEST)
    assert sorted(joined.stokes_i.real) == sorted(whole.stokes_i.real)


def test_an_observation_without_samples_has_no_block(seen):
    dark = VisibilitySet(PhaseCentre(0.0, 0.0), ())
    assert accumulate(dark, [Collector(10)]) == ([],)


class Releasing(BlockAccumulator[int]):
    """Counts the blocks that are released as soon as it holds them no longer."""

    def __init__(self):
        super().__init__(0.0, LONGEST, Gridding(block=400, executor=in_threads(2)))
        self.released = 0

    def add_block(self, samples):
        known = weakref.ref(samples)
        del samples
        self.released += known() is None

    def add_sums(self, later):
        self.released += later.released

    def total(self):
        return self.released


def test_a_block_is_held_by_nobody_but_the_work_on_it(seen):
    (released,) = accumulate(_in_pieces(seen, 5), [Releasing()])
    assert released == 4
