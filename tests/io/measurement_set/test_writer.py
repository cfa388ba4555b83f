"""Writing Measurement Sets."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from casacore import measures, quanta, tables

from tests.io.measurement_sets import PHASE_CENTRE, simulated, written
from tests.progress.heard import Heard
from uvshear.errors import InputError
from uvshear.execution import in_threads
from uvshear.interferometer.stokes import Hands
from uvshear.io import outputs
from uvshear.io.measurement_set import writer
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.simulation import observation as observation_module

REQUIRED_SUBTABLES = (
    "ANTENNA",
    "DATA_DESCRIPTION",
    "FEED",
    "FIELD",
    "FLAG_CMD",
    "HISTORY",
    "OBSERVATION",
    "POINTING",
    "POLARIZATION",
    "PROCESSOR",
    "SPECTRAL_WINDOW",
    "STATE",
)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return written(tmp_path_factory.mktemp("written"))


def _table(path, subtable=""):
    return tables.table(str(path / subtable), ack=False)


def test_the_main_table_holds_what_was_simulated(path):
    observation = simulated()
    blocks = list(observation.blocks())
    coverage = observation.coverage
    with _table(path) as main:
        np.testing.assert_array_equal(
            main.getcol("DATA"), np.concatenate([block.correlations for block in blocks])
        )
        sigma = np.concatenate([block.sigma for block in blocks])
        np.testing.assert_array_equal(main.getcol("SIGMA_SPECTRUM"), sigma)
        np.testing.assert_allclose(main.getcol("WEIGHT_SPECTRUM"), sigma**-2, rtol=1e-6)
        np.testing.assert_allclose(main.getcol("WEIGHT"), (sigma**-2).mean(axis=1), rtol=1e-6)
        np.testing.assert_allclose(main.getcol("SIGMA"), main.getcol("WEIGHT") ** -0.5, rtol=1e-6)
        np.testing.assert_array_equal(main.getcol("UVW"), coverage.uvw)
        np.testing.assert_array_equal(main.getcol("TIME"), coverage.time)
        np.testing.assert_array_equal(main.getcol("TIME_CENTROID"), coverage.time)
        np.testing.assert_array_equal(main.getcol("ANTENNA1"), coverage.antenna1)
        np.testing.assert_array_equal(main.getcol("ANTENNA2"), coverage.antenna2)
        assert not main.getcol("FLAG").any()


def test_constant_columns_have_their_value_in_every_row(path):
    with _table(path) as main:
        assert set(main.getcol("INTERVAL")) == {60.0}
        # of samples that are no averages
        assert set(main.getcol("EXPOSURE")) == {0.0}
        assert set(main.getcol("SCAN_NUMBER")) == {1}
        assert not main.getcol("FLAG_ROW").any()
        for column in ("ARRAY_ID", "DATA_DESC_ID", "FEED1", "FEED2", "FIELD_ID"):
            assert set(main.getcol(column)) == {0}
        for column in ("OBSERVATION_ID", "PROCESSOR_ID", "STATE_ID"):
            assert set(main.getcol(column)) == {0}


def test_it_is_the_set_that_casacore_writes_with_open_shapes_byte_for_byte(
    path, tmp_path, monkeypatch
):
    def create(path, observation):
        fixed, rows = writer.SAME_SHAPE_COLUMNS, len(observation.coverage)
        writer._create(path, observation, fixed, 1)
        writer._create(tmp_path / "all_rows.ms", observation, fixed, rows)

    monkeypatch.setattr(writer, "_create_twice", create)
    monkeypatch.setattr(Path, "write_bytes", lambda *_: None)
    slowly = written(tmp_path)
    # Subtables are written in the same way; casacore leaves bytes in them that it has not set.
    files, others = (
        {file.name: file.read_bytes() for file in found.iterdir() if file.is_file()}
        for found in (path, slowly)
    )
    # Its number of rows is as if all of them had been there from the start.
    others["table.dat"] = (tmp_path / "all_rows.ms" / "table.dat").read_bytes()
    for each in (files, others):
        del each["table.lock"]
    assert len(files) > 10
    assert files.keys() == others.keys()
    assert [name for name in files if files[name] != others[name]] == []


def test_it_can_be_read_without_its_lock_file(path, tmp_path):
    copy = shutil.copytree(path, tmp_path / "copy.ms")
    with _table(path) as main:
        rows = main.nrows()
    (copy / "table.lock").unlink()
    with _table(copy) as main:
        assert main.nrows() == rows
        assert main.getcell("DATA", rows - 1).ndim == 2


def test_cells_of_another_shape_can_be_added(path, tmp_path):
    copy = shutil.copytree(path, tmp_path / "longer.ms")
    with tables.table(str(copy), ack=False, readonly=False) as main:
        rows = main.nrows()
        before = main.getcell("DATA", rows - 1)
        main.addrows(1)
        main.putcell("DATA", rows, np.ones((7, 4), np.complex64))
    with _table(copy) as main:
        np.testing.assert_array_equal(main.getcell("DATA", rows), np.ones((7, 4)))
        np.testing.assert_array_equal(main.getcell("DATA", rows - 1), before)


def test_bulky_columns_are_tiled(path):
    with _table(path) as main:
        managers = main.getdminfo().values()
    kinds = {column: manager["TYPE"] for manager in managers for column in manager["COLUMNS"]}
    for column in ("DATA", "FLAG", "WEIGHT_SPECTRUM", "SIGMA_SPECTRUM"):
        assert kinds[column] == "TiledShapeStMan"
    assert kinds["UVW"] == "TiledColumnStMan"


def test_rows_with_another_number_of_channels_can_be_appended(tmp_path):
    """CASA's concat does so; where cells cannot have another shape, it appends rows without visibilities."""
    path = written(tmp_path, channels=4)
    columns = ("DATA", "FLAG", "WEIGHT_SPECTRUM", "SIGMA_SPECTRUM")
    with tables.table(str(path), readonly=False, ack=False) as main:
        before = {name: main.getcol(name) for name in columns}
        last = main.nrows()
        main.addrows(1)
        for name in columns:
            main.putcell(name, last, np.ones((7, 2), before[name].dtype))
    with _table(path) as main:
        for name in columns:
            np.testing.assert_array_equal(main.getcell(name, last), np.ones((7, 2)))
            np.testing.assert_array_equal(main.getcol(name, 0, last), before[name])


def test_uvw_is_j2000_and_times_are_utc(path):
    with _table(path) as main:
        assert main.getcolkeywords("UVW")["MEASINFO"] == {"type": "uvw", "Ref": "J2000"}
        assert main.getcolkeywords("TIME")["MEASINFO"]["Ref"] == "UTC"
        assert main.getkeyword("MS_VERSION") == 2.0


def test_every_required_subtable_is_there_and_filled(path):
    with _table(path) as main:
        keywords = main.getkeywords()
    for name in REQUIRED_SUBTABLES:
        # stored relative to the set, so that it could be renamed
        assert keywords[name] == f"Table: {path / name}"
        with _table(path, name) as subtable:
            assert subtable.nrows() > 0 or name == "FLAG_CMD"
            for column in subtable.colnames():
                for row in range(subtable.nrows()):
                    assert subtable.iscelldefined(column, row), f"{name}.{column}"


def test_identifiers_point_into_their_subtables(path):
    pairs = {
        "ANTENNA1": "ANTENNA",
        "ANTENNA2": "ANTENNA",
        "DATA_DESC_ID": "DATA_DESCRIPTION",
        "FIELD_ID": "FIELD",
        "OBSERVATION_ID": "OBSERVATION",
        "PROCESSOR_ID": "PROCESSOR",
        "STATE_ID": "STATE",
    }
    with _table(path) as main:
        for column, subtable in pairs.items():
            with _table(path, subtable) as pointed:
                assert main.getcol(column).max() < pointed.nrows()
    with _table(path, "FEED") as feed, _table(path, "ANTENNA") as antenna:
        np.testing.assert_array_equal(feed.getcol("ANTENNA_ID"), np.arange(antenna.nrows()))


def test_antennas_are_the_layout_s(path):
    layout = simulated().coverage.layout
    with _table(path, "ANTENNA") as antenna:
        np.testing.assert_array_equal(antenna.getcol("POSITION"), layout.positions)
        np.testing.assert_array_equal(antenna.getcol("DISH_DIAMETER"), layout.diameters)
        assert tuple(antenna.getcol("NAME")) == layout.antenna_names


def test_the_field_points_to_the_phase_centre(path):
    with _table(path, "FIELD") as field:
        for column in ("PHASE_DIR", "DELAY_DIR", "REFERENCE_DIR"):
            assert tuple(field.getcell(column, 0)[0]) == (PHASE_CENTRE.ra, PHASE_CENTRE.dec)
            assert field.getcolkeywords(column)["MEASINFO"]["Ref"] == "J2000"


def test_the_spectral_window_is_the_channels(path):
    channels = simulated().channels
    with _table(path, "SPECTRAL_WINDOW") as window:
        np.testing.assert_array_equal(window.getcell("CHAN_FREQ", 0), channels.frequency)
        for column in ("CHAN_WIDTH", "RESOLUTION"):
            np.testing.assert_array_equal(window.getcell(column, 0), channels.width)
        # nothing was averaged over
        np.testing.assert_array_equal(window.getcell("EFFECTIVE_BW", 0), 0.0)
        assert window.getcell("NUM_CHAN", 0) == 4
        assert window.getcell("TOTAL_BANDWIDTH", 0) == pytest.approx(240e6)
        assert window.getcell("REF_FREQUENCY", 0) == channels.frequency[0]


def test_hands_are_linear_unless_asked_otherwise(path, tmp_path):
    circular = tmp_path / "circular.ms"
    write_measurement_set(circular, simulated(), hands=Hands.CIRCULAR)
    for target, types, receptors in ((path, [9, 12], ["X", "Y"]), (circular, [5, 8], ["R", "L"])):
        with _table(target, "POLARIZATION") as polarization, _table(target, "FEED") as feed:
            assert list(polarization.getcell("CORR_TYPE", 0)) == types
            np.testing.assert_array_equal(polarization.getcell("CORR_PRODUCT", 0), [[0, 0], [1, 1]])
            kinds = feed.getcell("POLARIZATION_TYPE", 3)
            assert list(kinds["array"] if isinstance(kinds, dict) else kinds) == receptors


def test_the_observation_lasts_as_long_as_its_rows(path):
    time = simulated().coverage.time
    with _table(path, "OBSERVATION") as observation:
        np.testing.assert_allclose(
            observation.getcell("TIME_RANGE", 0), [time[0] - 30, time[-1] + 30], rtol=1e-15
        )


def test_casacore_s_own_measures_agree_with_the_baselines(path):
    """The time stamps, positions and directions of the file give back its UVW."""
    with _table(path) as main, _table(path, "ANTENNA") as antenna:
        row = main.nrows() - 5
        time, uvw = main.getcell("TIME", row), main.getcell("UVW", row)
        first, second = main.getcell("ANTENNA1", row), main.getcell("ANTENNA2", row)
        positions = antenna.getcol("POSITION")
    dm = measures.measures()
    dm.do_frame(dm.epoch("UTC", quanta.quantity(time, "s")))
    dm.do_frame(dm.position("ITRF", *(quanta.quantity(x, "m") for x in positions[0])))
    dm.do_frame(
        dm.direction(
            "J2000",
            quanta.quantity(PHASE_CENTRE.ra, "rad"),
            quanta.quantity(PHASE_CENTRE.dec, "rad"),
        )
    )
    difference = positions[first] - positions[second]
    baseline = dm.baseline("ITRF", *(quanta.quantity(x, "m") for x in difference))
    expected = dm.to_uvw(dm.measure(baseline, "J2000"))["xyz"].get_value("m")
    # measured 5e-5 (nutation); casacore and astropy disagree with any exchanged axis
    np.testing.assert_allclose(uvw, expected, atol=1e-4 * np.linalg.norm(uvw))


def test_progress_is_told_of_the_prediction_and_after_every_block(tmp_path, monkeypatch):
    monkeypatch.setattr(observation_module, "SAMPLES_PER_SLAB", 200)
    monkeypatch.setattr(observation_module, "SLABS_PER_BLOCK", 16)
    told, heard = [], Heard()
    write_measurement_set(
        tmp_path / "x.ms", simulated(), progress=lambda done, total: told.append((done, total))
    )
    assert told[-1][0] == told[-1][1] > told[0][0] > 0
    write_measurement_set(tmp_path / "y.ms", simulated(), progress=heard)
    assert heard.stages == ["preparation", "prediction", "writing"]
    writing = heard.all[heard.all.index(("begin", "writing", ())) + 1 :]
    assert [what[1] for what in writing[:3]] == [3200, 6400, 6720]
    assert writing[-1] == ("finish",)


def test_block_by_block_is_the_same_as_at_once(tmp_path, monkeypatch):
    monkeypatch.setattr(observation_module, "SAMPLES_PER_SLAB", 200)
    whole = written(tmp_path)
    monkeypatch.setattr(observation_module, "SLABS_PER_BLOCK", 1)
    pieces = tmp_path / "pieces.ms"
    write_measurement_set(pieces, simulated(), executor=in_threads(2))
    with _table(whole) as one, _table(pieces) as other:
        for column in ("DATA", "UVW", "WEIGHT_SPECTRUM", "TIME"):
            np.testing.assert_array_equal(one.getcol(column), other.getcol(column))


def test_an_existing_set_is_replaced_only_when_asked(tmp_path):
    path = written(tmp_path, seed=1)
    with pytest.raises(InputError, match=r"field\.ms: exists already"):
        write_measurement_set(path, simulated(seed=2))
    write_measurement_set(path, simulated(seed=2), overwrite=True)
    expected = next(simulated(seed=2).blocks()).correlations
    with _table(path) as main:
        np.testing.assert_array_equal(main.getcol("DATA"), expected)
    assert [entry.name for entry in tmp_path.iterdir()] == ["field.ms"]


def test_what_is_no_measurement_set_is_never_overwritten(tmp_path):
    precious = tmp_path / "thesis"
    precious.mkdir()
    (precious / "chapter").write_text("1")
    with pytest.raises(
        InputError, match="thesis: is not a Measurement Set, and will not be overwr"
    ):
        write_measurement_set(precious, simulated(), overwrite=True)
    assert (precious / "chapter").read_text() == "1"


def test_a_missing_directory_is_named(tmp_path):
    with pytest.raises(InputError, match=r"nowhere.* does not exist"):
        write_measurement_set(tmp_path / "nowhere" / "x.ms", simulated())


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError, InputError])
def test_an_interruption_leaves_the_old_set_and_nothing_else(tmp_path, error):
    path = written(tmp_path)
    before = sorted(entry.name for entry in path.iterdir())

    def interrupt(done, total):
        raise error

    expected = InputError if error is RuntimeError else error
    with pytest.raises(expected):
        write_measurement_set(path, simulated(seed=2), overwrite=True, progress=interrupt)
    assert [entry.name for entry in tmp_path.iterdir()] == ["field.ms"]
    assert sorted(entry.name for entry in path.iterdir()) == before
    first = next(simulated(seed=1).blocks()).correlations
    with _table(path) as main:
        np.testing.assert_array_equal(main.getcol("DATA"), first)


def test_a_set_that_cannot_be_put_in_place_is_kept_beside_the_old_one(tmp_path, monkeypatch):
    path = written(tmp_path)
    with tables.table(str(path), ack=False) as main:
        first = main.getcol("DATA")

    def fail(new, target):
        raise OSError("device or resource busy")

    monkeypatch.setattr(outputs, "replace", fail)
    with pytest.raises(
        InputError, match=r"cannot be put in place: device or resource busy; .*kept"
    ):
        write_measurement_set(path, simulated(seed=2), overwrite=True)
    (kept,) = tmp_path.glob("field.ms.kept-*")
    assert {entry.name for entry in tmp_path.iterdir()} == {"field.ms", kept.name}
    with tables.table(str(path), ack=False) as main:
        np.testing.assert_array_equal(main.getcol("DATA"), first)
    with tables.table(str(kept / "field.ms"), ack=False) as main:
        assert main.getcol("DATA").shape == first.shape
        assert not np.array_equal(main.getcol("DATA"), first)
