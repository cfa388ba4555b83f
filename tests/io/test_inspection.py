"""What a look at a Measurement Set finds, against what was written into it."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import PHASE_CENTRE, change, real_set, simulated, written
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.io.inspection import inspect
from uvshear.io.measurement_set import MeasurementSet
from uvshear.io.observations import Reading


def test_what_was_written_is_found(tmp_path):
    observation = simulated()
    seen = inspect(written(tmp_path, is_averaged=True))
    (content,) = seen.fields
    coverage = observation.coverage
    assert seen.telescope.name == "ska-mid-aa1"
    assert seen.telescope.antennas == 8
    assert seen.correlations == (("XX", "YY"),)
    assert content.data.phase_centre == PHASE_CENTRE
    assert content.counts.rows == len(coverage)
    assert content.interval == (60.0, 60.0)
    assert content.time[1] - content.time[0] == pytest.approx(3600)
    metres = np.hypot(coverage.uvw[:, 0], coverage.uvw[:, 1])
    np.testing.assert_allclose(content.baseline, (metres.min(), metres.max()))
    per_metre = observation.channels.frequency / SPEED_OF_LIGHT
    ends = metres.min() * per_metre.min(), metres.max() * per_metre.max()
    np.testing.assert_allclose(content.uv_distance, ends)
    assert content.noise_over_weights == pytest.approx(1.0, abs=0.03)
    assert content.uvw_agrees


def test_all_fields_are_looked_at(tmp_path):
    path = written(tmp_path)
    change(path, "FIELD_ID", 1, rows=slice(0, 100))
    with tables.table(str(path / "FIELD"), readonly=False, ack=False) as fields:
        fields.addrows(1)
        fields.putcell("NAME", 1, "calibrator")
        fields.putcell("PHASE_DIR", 1, fields.getcell("PHASE_DIR", 0))
    first, second = inspect(path).fields
    assert (first.name, second.name) == ("simulated", "calibrator")
    assert second.counts.rows == 100
    assert first.counts.rows == len(simulated().coverage) - 100
    assert [one.name for one in inspect(path, Reading(field="calibrator")).fields] == ["calibrator"]


def test_a_set_of_flags_alone_is_looked_at_too(tmp_path):
    path = written(tmp_path)
    change(path, "FLAG", value=True)
    (content,) = inspect(path).fields
    assert content.counts.usable == 0
    assert content.counts.flagged_fraction == 1
    assert content.noise_over_weights is None


def test_a_real_set_says_where_it_is_from(tmp_path):
    seen = inspect(real_set(tmp_path, "day2_TDEM0003_10s_norx_1src_1spw.ms.tar.gz"))
    assert seen.telescope.name == "EVLA"
    assert seen.telescope.diameters == (25.0,)
    assert seen.correlations == (("RR", "RL", "LR", "LL"),)
    assert seen.fields[0].name == "J1008+0730"
    assert seen.fields[0].uvw_agrees


def test_what_is_no_set_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        inspect(tmp_path / "absent.ms")


def test_rows_carry_what_they_were_averaged_over(tmp_path):
    coverage = simulated().coverage
    path = written(tmp_path, is_averaged=True)
    chunks = list(MeasurementSet(path, memory=2**14).chunks())
    taken = [chunk.integrations for chunk in chunks]
    assert len(taken) > 1
    antennas = np.concatenate([one.antennas for one in taken])
    np.testing.assert_array_equal(antennas[:, 0], coverage.antenna1)
    np.testing.assert_array_equal(antennas[:, 1], coverage.antenna2)
    np.testing.assert_allclose(np.concatenate([one.time for one in taken]), coverage.time)
    assert all(np.all(one.interval == 60) for one in taken)
    np.testing.assert_allclose(chunks[0].width, simulated().channels.width)


def test_a_simulation_of_moments_and_frequencies_was_not_averaged(tmp_path):
    (chunk, *_) = MeasurementSet(written(tmp_path)).chunks()
    assert not chunk.integrations.interval.any()
    assert not chunk.width.any()


def test_a_set_that_does_not_say_is_averaged_over_its_channels(tmp_path):
    path = written(tmp_path)
    change(path, "EFFECTIVE_BW", np.nan, subtable="SPECTRAL_WINDOW")
    (chunk, *_) = MeasurementSet(path).chunks()
    np.testing.assert_allclose(chunk.width, simulated().channels.width)
