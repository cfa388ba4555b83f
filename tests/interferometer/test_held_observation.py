"""Observations that are read once."""

import pickle
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from tests.io.measurement_sets import written
from tests.skies import L_BAND, random_baselines
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.held_observation import (
    HeldObservation,
    blocks_of,
    held,
    held_by_parts,
    release,
)
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.origin import Origin, origin_of, parts_of
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import Visibilities
from uvshear.io.measurement_set.observation import MeasurementSet

ROWS = 20


class Counting:
    """Counts how often it is read."""

    def __init__(self):
        self.readings = 0
        self.phase_centre = PhaseCentre(0.1, -0.5)

    def origin(self):
        return Origin(self, "counted")

    def chunks(self):
        self.readings += 1
        uvw = random_baselines(ROWS, 7e3)
        for number in range(3):
            vis = np.full((ROWS, 1), number + 0j)
            vis[number] = np.nan
            yield Visibilities(uvw, L_BAND, vis, np.ones((ROWS, 1)))


def test_an_observation_is_read_once_and_gives_the_same_chunks_again():
    observation = Counting()
    held = HeldObservation(observation, 1e6)
    first, later = list(held.chunks()), list(held.chunks())
    assert observation.readings == 1
    assert [id(chunk) for chunk in first] == [id(chunk) for chunk in later]
    assert held.phase_centre == observation.phase_centre
    # What cannot be right is left out, and is not looked for again.
    assert [int(np.flatnonzero(chunk.weights[:, 0] == 0)[0]) for chunk in later] == [0, 1, 2]
    assert all(chunk.is_screened for chunk in later)


def test_a_reading_that_was_given_up_is_not_kept():
    observation = Counting()
    held = HeldObservation(observation, 1e6)
    assert len(list(islice(held.chunks(), 2))) == 2
    assert len(list(held.chunks())) == 3
    assert observation.readings == 2


def test_an_observation_that_does_not_fit_is_read_as_often_as_it_is_needed():
    chunk = next(Counting().chunks())
    size = 3 * (chunk.uvw.nbytes + chunk.stokes_i.nbytes + chunk.weights.nbytes)
    for memory, readings in ((size, 1), (size - 1, 2)):
        observation = Counting()
        held = HeldObservation(observation, memory)
        for _ in range(2):
            assert [chunk.stokes_i[-1, 0] for chunk in held.chunks()] == [0, 1, 2]
        assert observation.readings == readings


def test_parts_are_held_one_by_one_and_keep_their_origins():
    parts = Counting(), Counting()
    held = held_by_parts(JointObservation(parts[0].phase_centre, parts), 1e6)
    for part in parts_of(held):
        assert len(list(part.chunks())) == 3
    assert len(list(held.chunks())) == 6
    assert [part.readings for part in parts] == [1, 1]
    assert [origin_of(part).observation for part in parts_of(held)] == list(parts)


def test_what_is_released_is_read_again():
    parts = Counting(), Counting()
    held = held_by_parts(JointObservation(parts[0].phase_centre, parts), 1e6)
    for _ in range(2):
        assert len(list(held.chunks())) == 6
        release(held)
    assert [part.readings for part in parts] == [2, 2]


def test_a_single_part_is_held_as_it_is():
    observation = Counting()
    held = held_by_parts(observation, 1e6)
    assert len(list(held.chunks())) == len(list(held.chunks())) == 3
    assert observation.readings == 1
    assert origin_of(held).name == "counted"


@pytest.fixture(scope="module")
def in_file(tmp_path_factory):
    """A set of 1680 rows in 20 chunks."""
    return MeasurementSet(written(tmp_path_factory.mktemp("held")), memory=2**15)


def test_a_file_is_held_range_by_range(in_file, monkeypatch):
    held_ranges = held_by_parts(in_file, 1e9, samples=2000)
    assert len(held_ranges.partitions) == 4
    first = list(held_ranges.chunks())
    monkeypatch.setattr(MeasurementSet, "rows_between", None)  # nothing is read again
    assert [id(chunk) for chunk in held_ranges.chunks()] == [id(chunk) for chunk in first]
    whole = list(screened_chunks(in_file))
    for chunk, expected in zip(first, whole, strict=True):
        np.testing.assert_array_equal(chunk.stokes_i, expected.stokes_i)
    release(held_ranges)
    with pytest.raises(TypeError):
        list(held_ranges.chunks())


def test_what_is_held_is_not_sent_with_it(in_file):
    held_ranges = held_by_parts(in_file, 1e9, samples=2000)
    first = list(held_ranges.chunks())
    message = pickle.dumps(blocks_of(held_ranges, 2000))
    assert len(message) < 20_000
    again = [chunk for block in pickle.loads(message) for chunk in block.chunks()]
    for chunk, expected in zip(again, first, strict=True):
        np.testing.assert_array_equal(chunk.stokes_i, expected.stokes_i)


def test_blocks_are_made_of_as_many_ranges_as_fit(in_file):
    both = JointObservation(in_file.phase_centre, (in_file, in_file))
    for samples, count in ((2000, 8), (4500, 4), (8000, 2), (10**6, 1)):
        blocks = blocks_of(held_by_parts(both, 1e9, samples=2000), samples)
        assert len(blocks) == count
        total = sum(len(chunk) for block in blocks for chunk in block.chunks())
        assert total == 2 * 1680


def test_what_is_not_in_a_file_has_no_such_blocks(in_file):
    observation = Counting()
    as_it_is = held_by_parts(observation, 1e6, samples=10)
    assert isinstance(as_it_is, HeldObservation)
    assert blocks_of(as_it_is, 10) is None
    assert isinstance(held(observation, 1e6), HeldObservation)
    ranges = held_by_parts(in_file, 1e6, samples=10**6)
    assert held(ranges, 1e6) is ranges


def test_a_file_without_a_usable_visibility_is_refused_in_ranges_too(in_file, monkeypatch):
    def flagged(observation, first, stop):
        for seen in chunks(observation, first, stop):
            nothing = replace(seen.counts, usable=0, flagged=seen.counts.samples)
            yield replace(seen, weights=0 * seen.weights, counts=nothing)

    chunks = MeasurementSet.rows_between
    monkeypatch.setattr(MeasurementSet, "rows_between", flagged)
    with pytest.raises(InputError, match="all visibilities are flagged"):
        list(held_by_parts(in_file, 1e9, samples=2000).chunks())
