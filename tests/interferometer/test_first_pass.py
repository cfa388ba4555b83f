"""The first pass: everything from one reading."""

from dataclasses import dataclass

import numpy as np
import pytest

from tests.interferometer.chunks import CENTRE, chunk, observation, without_weight
from uvshear.errors import InputError
from uvshear.execution import Threads
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.baseline_map import map_baselines
from uvshear.interferometer.first_pass import first_pass
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.noise_estimate import estimate_noise
from uvshear.interferometer.origin import Origin
from uvshear.interferometer.summary import summarise
from uvshear.interferometer.visibilities import VisibilitySet


@dataclass
class Opened:
    """An observation from a file, which counts how often it is read."""

    name: str
    noise: float = 1.0
    readings: int = 0
    phase_centre: PhaseCentre = CENTRE

    def chunks(self):
        self.readings += 1
        yield from observation(1, 2, 3, noise=self.noise).chunks()

    def origin(self):
        return Origin(self, self.name)

    def notices(self):
        return ("it is odd",) if self.name == "odd" else ()


def test_everything_is_from_one_reading():
    data = Opened("a")
    first = first_pass(data, Threads(2))
    assert data.readings == 1
    assert first.summary.weight == summarise(data).weight
    np.testing.assert_array_equal(first.baselines.weight, map_baselines(data).weight)
    (quality,) = first.qualities
    assert (quality.name, quality.counts.samples) == ("a", 3 * 960)
    (sample,) = first.noise_samples
    assert estimate_noise(sample).ratio == pytest.approx(1.0, abs=0.05)
    assert first.warnings == ()


def test_parts_are_told_apart_in_warnings_and_joined_in_the_rest():
    good, loud, odd = Opened("good"), Opened("loud", noise=3.0), Opened("odd")
    joint = JointObservation(CENTRE, (good, loud, odd))
    first = first_pass(joint)
    assert (good.readings, loud.readings, odd.readings) == (1, 1, 1)
    assert first.summary.rows == 3 * 720
    assert first.summary.weight == pytest.approx(summarise(joint).weight)
    assert first.warnings == ("odd: it is odd",)
    noise = [estimate_noise(sample).ratio for sample in first.noise_samples]
    # 3000 samples: 1.3 per cent
    assert noise == pytest.approx([1.0, 3.0, 1.0], rel=0.05)


def test_samples_of_many_parts_take_no_more_memory_than_those_of_a_few(monkeypatch):
    monkeypatch.setattr("uvshear.interferometer.first_pass.MOST_OF_ALL", 1000)
    monkeypatch.setattr("uvshear.interferometer.first_pass.FEWEST_OF_A_PART", 10)
    joint = JointObservation(CENTRE, tuple(observation(1, 2) for _ in range(5)))
    drawn = [len(sample.here) for sample in first_pass(joint).noise_samples]
    assert drawn == [200] * 5


def test_a_part_without_weight_does_not_matter():
    empty = VisibilitySet(CENTRE, (without_weight(chunk(1)),))
    first = first_pass(JointObservation(CENTRE, (empty, observation(1))))
    assert first.summary.samples == summarise(observation(1)).samples


def test_an_observation_without_any_weight_is_an_error():
    with pytest.raises(InputError, match="no visibility carries weight"):
        first_pass(VisibilitySet(CENTRE, (without_weight(chunk(1)),)))
