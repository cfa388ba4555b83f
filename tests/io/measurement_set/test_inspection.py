"""Inspection of a Measurement Set, against what was written into it."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import PHASE_CENTRE, change, real_set, simulated, written
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.observations import inspect
from uvshear.io.reading import Reading


def test_what_was_written_is_found(tmp_path):
    observation = simulated()
    seen = inspect(written(tmp_path, is_averaged=True))
    (content,) = seen.fields
    coverage = observation.coverage
    assert seen.telescope.name == "ska-mid-aa1"
    assert seen.telescope.antennas == 8
    (window,) = seen.windows
    assert window.correlations == ("XX", "YY")
    np.testing.assert_allclose(window.frequency, observation.channels.frequency)
    np.testing.assert_allclose(window.averaged, observation.channels.width)
    assert seen.columns == ("DATA",)
    assert content.phase_centre == PHASE_CENTRE
    assert (content.number, content.name) == (0, "simulated")
    assert content.weight_column == "WEIGHT_SPECTRUM"
    assert content.counts.rows == len(coverage)
    ranges = content.ranges
    assert ranges.interval == (60.0, 60.0)
    assert ranges.time[1] - ranges.time[0] == pytest.approx(3600)
    metres = np.hypot(coverage.uvw[:, 0], coverage.uvw[:, 1])
    np.testing.assert_allclose(ranges.baseline, (metres.min(), metres.max()))
    per_metre = observation.channels.frequency / SPEED_OF_LIGHT
    ends = metres.min() * per_metre.min(), metres.max() * per_metre.max()
    np.testing.assert_allclose(ranges.uv_distance, ends)
    assert content.noise.ratio == pytest.approx(1.0, abs=0.03)
    assert content.uvw_agrees


def test_all_fields_are_inspected(tmp_path):
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
    (chosen,) = inspect(path, Reading(field="calibrator")).fields
    assert chosen.name == "calibrator"


def test_the_set_is_read_once(tmp_path, monkeypatch):
    path, readings = written(tmp_path), []
    read = MeasurementSet.unchecked_chunks

    def counted(data):
        readings.append(data.path)
        return read(data)

    monkeypatch.setattr(MeasurementSet, "unchecked_chunks", counted)
    inspect(path)
    assert len(readings) == 1


def test_a_set_in_which_all_is_flagged_is_inspected_too(tmp_path):
    path = written(tmp_path)
    change(path, "FLAG", value=True)
    (content,) = inspect(path).fields
    assert content.counts.usable == 0
    assert content.counts.flagged_fraction == 1
    assert content.noise is None


@pytest.mark.real
def test_a_real_set_tells_its_telescope(tmp_path):
    seen = inspect(real_set(tmp_path, "day2_TDEM0003_10s_norx_1src_1spw.ms.tar.gz"))
    assert seen.telescope.name == "EVLA"
    assert seen.telescope.diameters == (25.0,)
    assert [window.correlations for window in seen.windows] == [("RR", "RL", "LR", "LL")]
    assert seen.fields[0].name == "J1008+0730"
    assert seen.fields[0].uvw_agrees
