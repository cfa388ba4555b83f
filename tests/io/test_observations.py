"""Files of visibilities opened as one observation."""

import shutil
from contextlib import contextmanager

import numpy as np
import pytest

from tests.execution.tasks import children
from tests.interferometer.chunks import CENTRE, observation
from tests.io.measurement_sets import PHASE_CENTRE, change, simulated, written
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.interferometer.dishes import dish_diameters, pointing_of
from uvshear.interferometer.first_pass import first_pass
from uvshear.interferometer.noise_estimate import estimate_noise
from uvshear.interferometer.origin import origin_of, parts_of
from uvshear.interferometer.scaled_observation import ScaledObservation, scaled_to_its_noise
from uvshear.io import observations
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.observations import open_observation
from uvshear.io.readers import Reader
from uvshear.io.reading import Reading


class NightReader(Reader):
    """A format with nothing but a phase centre and chunks, one seed a file name."""

    format = "night"

    def recognises(self, path):
        return True

    def open(self, path, reading):
        return observation(int(path.name))


@pytest.fixture
def pair(tmp_path):
    first = written(tmp_path)
    second = tmp_path / "second.ms"
    shutil.copytree(first, second)
    return first, second


@pytest.fixture
def readings(monkeypatch):
    """Paths of the sets whose visibilities were read, in order."""
    paths = []
    read = MeasurementSet.chunks

    def counted(data):
        paths.append(data.path)
        return read(data)

    monkeypatch.setattr(MeasurementSet, "chunks", counted)
    return paths


@pytest.mark.parametrize(
    "kind", [str, lambda path: path, lambda path: [path], lambda path: (str(path),)]
)
def test_one_path_is_opened_as_it_is(tmp_path, kind):
    path = written(tmp_path)
    opened = open_observation(kind(path), Reading(conjugates=True))
    assert isinstance(opened, MeasurementSet)
    assert opened.conjugates


def test_several_paths_are_one_observation(pair):
    joint = open_observation(pair)
    assert joint.phase_centre == PHASE_CENTRE
    assert [origin_of(part).name for part in parts_of(joint)] == [str(path) for path in pair]
    assert sum(len(chunk) for chunk in joint.chunks()) == 2 * len(simulated().coverage)


def test_each_part_is_prepared_for_itself(pair):
    joint = open_observation(pair, prepared=lambda part: ScaledObservation(part, 2.0))
    assert all(isinstance(part, ScaledObservation) for part in joint.parts)


def test_a_file_given_twice_is_refused(pair):
    first, _ = pair
    with pytest.raises(InputError, match="is given twice"):
        open_observation([first, str(first)])


def test_no_file_is_refused():
    with pytest.raises(InputError, match="one or more are needed"):
        open_observation([])


def test_another_phase_centre_is_refused_by_name(pair):
    first, second = pair
    change(
        second,
        "PHASE_DIR",
        np.array([[PHASE_CENTRE.ra, PHASE_CENTRE.dec + ARCSEC]]),
        subtable="FIELD",
    )
    with pytest.raises(
        InputError, match=f"{second}: its phase centre is 1 arcsec from that of {first}"
    ):
        open_observation(pair)


def test_the_first_pass_reads_every_set_once_and_names_it(pair, readings):
    change(pair[1], "WEIGHT", 0.0)
    change(pair[1], "WEIGHT_SPECTRUM", 0.0)
    first = first_pass(open_observation(pair))
    assert readings == list(pair)
    (warning,) = first.warnings
    assert warning.startswith(f"{pair[1]}: WEIGHT has no value above zero")
    assert first.qualities[0].counts.samples == 6720


def test_each_set_is_scaled_to_a_noise_of_its_own(pair):
    change(pair[1], "WEIGHT_SPECTRUM", 1.0)
    joint = open_observation(pair, prepared=scaled_to_its_noise)
    first, second = (part.noise for part in joint.parts)
    assert first == pytest.approx(1.0, abs=0.03)
    assert second < 0.1
    for sample in first_pass(joint).noise_samples:
        assert estimate_noise(sample).ratio == pytest.approx(1.0, abs=0.03)


def test_what_the_metadata_tell_is_a_warning_too(pair):
    first, _ = pair
    for column in ("WEIGHT", "WEIGHT_SPECTRUM"):
        change(first, column, 0.0)
    (found,) = first_pass(open_observation(first)).warnings
    assert found == f"{first}: WEIGHT has no value above zero; the weights are 1/SIGMA^2"


def test_dishes_are_those_of_all_sets(pair):
    joint = open_observation(pair)
    np.testing.assert_array_equal(dish_diameters(joint), simulated().dish_diameters())
    assert pointing_of(joint) == (0.0, 0.0)
    change(pair[1], "DISH_DIAMETER", 25.0, subtable="ANTENNA")
    with pytest.raises(InputError, match=f"{pair[1]}: its dishes differ from those of {pair[0]}"):
        dish_diameters(open_observation(pair))


def test_a_format_of_chunks_alone_is_enough(tmp_path):
    paths = [tmp_path / "1", tmp_path / "2"]
    joint = open_observation(paths, Reading(reader=NightReader()))
    assert joint.phase_centre == CENTRE
    first = first_pass(joint)
    assert first.summary.rows == 480
    assert first.warnings == ()


def test_files_are_tried_side_by_side(pair, monkeypatch):
    events = []

    @contextmanager
    def trial(path, _):
        events.append(("begin", path))
        yield lambda: events.append(("wait", path))
        events.append(("end", path))

    monkeypatch.setattr("uvshear.io.measurement_set.reader.trial", trial)
    open_observation(pair)
    first, second = pair
    began_and_waited = [(what, path) for what in ("begin", "wait") for path in (first, second)]
    assert events == [*began_and_waited, ("end", second), ("end", first)]


def test_many_files_are_opened_a_few_at_a_time(monkeypatch):
    events = []

    class Counting(NightReader):
        @contextmanager
        def begin(self, path, reading):
            events.append(1)
            yield lambda: events.append(-1) or self.open(path, reading)

    monkeypatch.setattr(observations, "AT_ONCE", 3)
    seen = open_observation([str(k) for k in range(8)], Reading(reader=Counting()))
    assert len(parts_of(seen)) == 8
    assert np.cumsum(events).max() == 3
    assert sum(events) == 0


def test_no_trial_outlasts_a_refusal(pair, tmp_path):
    before = children()
    with pytest.raises(InputError, match="no such file"):
        open_observation([*pair, tmp_path / "absent.ms"])
    assert children() == before
