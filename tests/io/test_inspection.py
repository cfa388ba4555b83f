"""Inspection of files, whatever their format."""

from pathlib import Path

import numpy as np
import pytest

from tests.io.measurement_sets import simulated, written
from uvshear.errors import InputError
from uvshear.interferometer.visibilities import Observation
from uvshear.io.inspection import inspect_observation
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.observations import inspect
from uvshear.io.readers import Reader
from uvshear.io.reading import Reading


class SimulatedReader(Reader):
    """A reader that has nothing but what it must have."""

    format = "a simulation"

    def recognises(self, path: Path) -> bool:
        return True

    def open(self, path: Path, reading: Reading) -> Observation:
        return simulated()


def test_a_file_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        inspect(tmp_path / "absent.ms")


def test_a_reader_without_an_inspection_of_its_own_tells_what_one_pass_tells():
    seen = inspect("anything", Reading(reader=SimulatedReader()))
    (content,) = seen.fields
    metres = np.hypot(*simulated().coverage.uvw[:, :2].T)
    assert seen.telescope is None
    assert content.number is None
    assert content.phase_centre == simulated().phase_centre
    np.testing.assert_allclose(content.ranges.baseline, (metres.min(), metres.max()))
    assert content.noise.ratio == pytest.approx(1.0, abs=0.03)
    # The pass counts what the reader has not counted.
    assert content.counts.rows == len(metres)
    assert content.counts.samples == content.counts.usable > 0
    assert content.warnings == ()


def test_the_inspection_of_any_observation_agrees_with_that_of_the_set(tmp_path):
    path = written(tmp_path)
    (own,) = inspect(path).fields
    (general,) = inspect_observation(MeasurementSet(path)).fields
    assert general.ranges == own.ranges
    assert general.quality == own.quality
