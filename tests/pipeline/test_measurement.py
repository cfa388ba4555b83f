"""A measurement in memory and in files."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table

from tests.pipeline.fields import METHOD, MODEL, SIGMA
from uvshear.errors import InputError
from uvshear.execution import Resources, Serial
from uvshear.extraction import PaperExtraction
from uvshear.io.provenance import Provenance
from uvshear.pipeline import measurement as measurement_module
from uvshear.pipeline.measure import measure
from uvshear.pipeline.measurement import companions, read_measurement
from uvshear.pipeline.shear import estimate_shear

FILES = {"shapes.fits", "shapes.stats.fits", "shapes.sky.fits"}


def _names(directory):
    return {path.name for path in directory.iterdir()}


def test_a_representation_says_what_was_measured_and_how(kept):
    first, snr, statistics, cycles, record = repr(kept).splitlines()
    assert first == (
        "Measurement of 7 sources: 1 below_horizon, 4 ok, 1 outside_field, 1 point_source"
    )
    assert "signal-to-noise ratio" in snr
    assert "median error of e" in snr
    assert statistics.strip() == "statistics kept for: moments"
    assert "extraction converged" in record
    assert "major cycles; one more would change the model of a source by" in cycles
    assert "left_undone" not in repr(kept)
    assert max(map(len, repr(kept).splitlines())) < 250


def test_the_representation_of_a_measurement_without_a_shape_reads_well(kept):
    shapes = kept.shapes[[4]]
    text = repr(replace(kept, shapes=shapes, statistics=None, record={}))
    assert "Measurement of 1 sources: 1 outside_field" in text
    assert "statistics kept for: none (only `mean` can be used)" in text
    assert "nan" not in text


def test_what_is_written_is_read_again(kept, tmp_path):
    path = tmp_path / "shapes.fits"
    kept.write(path)
    assert _names(tmp_path) == FILES
    again = read_measurement(str(path))
    assert len(again) == len(kept)
    for name in ("e1", "e2", "snr", "weight"):
        np.testing.assert_array_equal(again.shapes[name], kept.shapes[name])
    np.testing.assert_array_equal(again.statistics["m1"], kept.statistics["m1"])
    np.testing.assert_allclose(again.sky.flux, kept.sky.flux)
    assert again.record == kept.record
    assert "statistics kept for: moments" in repr(again)
    for estimator in ("mean", "moments"):
        assert estimate_shear(again, estimator).numbers() == pytest.approx(
            estimate_shear(kept, estimator).numbers()
        )


def test_files_of_version_0_1_0_are_read(kept, tmp_path):
    """They have no file of the sky, name no estimators, and their record has no range of baselines."""
    path = tmp_path / "shapes.fits"
    old = kept.shapes.copy()
    record = {"extraction": "converged", "visits": 3, "left_undone": 0.05, "tolerance": 0.1}
    old.meta = {"ra0_deg": old.meta["ra0_deg"], "dec0_deg": old.meta["dec0_deg"]}
    old.meta |= {"version": "uvshear 0.1.0", "extract": json.dumps(record)}
    old.write(path)
    statistics = kept.statistics.copy()
    statistics.meta.clear()
    statistics.write(companions(path)[0])
    again = read_measurement(path)
    assert again.sky is None
    assert again.estimators == ("moments",)
    assert "visits 3" in repr(again)
    for estimator in ("mean", "moments"):
        assert estimate_shear(again, estimator).numbers() == pytest.approx(
            estimate_shear(kept, estimator).numbers()
        )


def test_a_read_measurement_can_be_written_elsewhere(kept, tmp_path):
    (tmp_path / "first").mkdir()
    (tmp_path / "second").mkdir()
    kept.write(tmp_path / "first" / "shapes.fits")
    read_measurement(tmp_path / "first" / "shapes.fits").write(tmp_path / "second" / "shapes.fits")
    for name in FILES:
        first, second = (Table.read(tmp_path / place / name) for place in ("first", "second"))
        assert first.meta["COMMAND"] == second.meta["COMMAND"] == "uvshear.measure"
        assert first.meta["DATE"] == second.meta["DATE"]


@pytest.mark.parametrize("name", sorted(FILES))
def test_nothing_that_exists_is_replaced_unless_asked(kept, tmp_path, name):
    (tmp_path / name).write_text("kept")
    with pytest.raises(InputError, match="exists already"):
        kept.write(tmp_path / "shapes.fits")
    assert _names(tmp_path) == {name}
    assert (tmp_path / name).read_text() == "kept"
    if name == "shapes.fits":
        kept.write(tmp_path / "shapes.fits", overwrite=True)
        assert _names(tmp_path) == FILES
        return
    # It might be a catalogue: only what a measurement wrote is replaced.
    with pytest.raises(InputError, match="exists already, and no measurement wrote it"):
        kept.write(tmp_path / "shapes.fits", overwrite=True)
    assert (tmp_path / name).read_text() == "kept"


def test_companions_of_a_table_that_is_gone_are_replaced(kept, tmp_path):
    path = tmp_path / "shapes.fits"
    kept.write(path)
    path.unlink()
    other = replace(kept, statistics=None)
    other.write(path)
    assert _names(tmp_path) == FILES - {"shapes.stats.fits"}
    with pytest.raises(InputError, match="exists already; give --overwrite"):
        other.write(path)


def test_tables_in_two_formats_do_not_share_files(kept, tmp_path):
    kept.write(tmp_path / "shapes.fits")
    replace(kept, statistics=None).write(tmp_path / "shapes.ecsv")
    replace(kept, statistics=None).write(tmp_path / "shapes.ecsv", overwrite=True)
    assert _names(tmp_path) == FILES | {"shapes.ecsv", "shapes.ecsv.sky.fits"}
    assert read_measurement(tmp_path / "shapes.fits").estimators == ("moments",)
    assert read_measurement(tmp_path / "shapes.ecsv").statistics is None


def _another(kept):
    shapes = kept.shapes.copy()
    shapes["e1"] += 0.01
    return replace(kept, shapes=shapes)


@pytest.mark.parametrize("name", ["shapes.stats.fits", "shapes.sky.fits"])
def test_files_of_two_measurements_are_not_mixed(kept, tmp_path, name):
    """As a process that is killed between two renames leaves them."""
    for place, measurement in (("first", kept), ("second", _another(kept))):
        (tmp_path / place).mkdir()
        measurement.write(tmp_path / place / "shapes.fits")
    (tmp_path / "second" / name).replace(tmp_path / "first" / name)
    with pytest.raises(InputError, match=f"{name}: belongs to another measurement than"):
        read_measurement(tmp_path / "first" / "shapes.fits")


def test_shapes_cut_to_some_rows_have_the_shear_of_these_rows(kept, tmp_path):
    path = tmp_path / "shapes.fits"
    kept.write(path)
    ok = np.flatnonzero(kept.shapes["flag"] == "ok")[[2, 0, 1]]
    expected = estimate_shear(kept, "moments", where=np.isin(np.arange(len(kept)), ok))
    Table.read(path)[ok].write(path, overwrite=True)
    found = estimate_shear(read_measurement(path), "moments")
    assert found.numbers()["n"] == 3
    assert found.numbers() == pytest.approx(expected.numbers(), nan_ok=True)


@pytest.mark.parametrize("failing", ["write_shapes", "write_statistics", "write_catalogue"])
def test_all_files_are_written_or_none(kept, tmp_path, monkeypatch, failing):
    def fail(*_args, **_more):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(measurement_module, failing, fail)
    with pytest.raises(InputError, match="cannot be written: No space left"):
        kept.write(tmp_path / "shapes.fits")
    assert _names(tmp_path) == set()
    (tmp_path / "shapes.fits").write_text("kept")
    with pytest.raises(InputError, match="cannot be written: No space left"):
        kept.write(tmp_path / "shapes.fits", overwrite=True)
    assert (tmp_path / "shapes.fits").read_text() == "kept"


def test_statistics_of_an_earlier_measurement_do_not_stay(kept, tmp_path):
    path = tmp_path / "shapes.fits"
    kept.write(path)
    replace(kept, statistics=None).write(path, overwrite=True)
    assert not companions(path)[0].exists()
    assert read_measurement(path).statistics is None


def test_files_say_how_they_were_made(kept, tmp_path):
    made = Provenance("my program", ("a.ms",), {"x": 1})
    kept.with_provenance(made).write(tmp_path / "shapes.fits")
    for name in FILES:
        meta = Table.read(tmp_path / name).meta
        assert meta["COMMAND"] == "my program"
        assert meta["INPUTS"] == '["a.ms"]'
    assert kept.shapes.meta["command"] == "uvshear.measure"


def test_the_residual_image_is_of_noise(kept):
    heard = []
    images = kept.residual_image(progress=lambda *x: heard.append(x))
    assert images.rms == pytest.approx(images.noise, rel=0.25)
    assert heard[-1][0] == heard[-1][1]


def test_a_read_measurement_has_the_same_residual_image(field, kept, tmp_path):
    kept.write(tmp_path / "shapes.fits")
    again = read_measurement(tmp_path / "shapes.fits")
    with pytest.raises(InputError, match="read from files, which do not contain the visibilities"):
        again.residual_image()
    images = again.residual_image(field.observation, model=MODEL, resources=Resources(Serial()))
    expected = kept.residual_image()
    # Coordinates go through degrees: parts in 1e12 of a turn.
    np.testing.assert_allclose(images.residual, expected.residual, rtol=0, atol=1e-4 * SIGMA)
    np.testing.assert_allclose(images.dirty, expected.dirty, rtol=0, atol=1e-4 * SIGMA)


def test_the_residual_image_of_the_paper_s_extraction_is_without_averaging(field, tmp_path):
    """It models none, and its record says so to whoever reads it again."""
    method = replace(METHOD, extraction=PaperExtraction())
    found = measure(
        field.observation,
        field.catalogue,
        model=MODEL,
        method=method,
        resources=Resources(Serial()),
    )
    assert found.record["models_attenuation"] is False
    found.write(tmp_path / "shapes.fits")
    assert read_measurement(tmp_path / "shapes.fits").record["models_attenuation"] is False


def test_without_the_fitted_sky_there_is_no_residual_image(kept):
    with pytest.raises(InputError, match="fitted sky is not available"):
        replace(kept, sky=None).residual_image()


def test_a_path_of_no_table_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_measurement(Path(tmp_path) / "absent.fits")
