"""Observations that are read once."""

from itertools import islice

import numpy as np

from tests.skies import L_BAND, random_baselines
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.held_observation import HeldObservation, held_by_parts, release
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.origin import Origin, origin_of, parts_of
from uvshear.interferometer.visibilities import Visibilities

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
