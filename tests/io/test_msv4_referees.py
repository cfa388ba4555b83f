"""MSv4 stores that xradio and xarray-ms have made of Measurement Sets, read like these sets."""

import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_set.varied_sets import Window, write_varied
from tests.io.measurement_sets import (
    averaged_by_baseline,
    change,
    real_set,
    simulated,
    with_rows,
    written,
)
from tests.io.msv4.rows import assert_same, rows_of
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.msv4.observation import Msv4Store
from uvshear.io.observations import inspect

pytestmark = pytest.mark.referee

XRADIO = """
from xradio.measurement_set import convert_msv2_to_processing_set
convert_msv2_to_processing_set({ms!r}, {store!r}, partition_scheme={scheme!r}, persistence_mode="w")
"""
XARRAY_MS = """
import xarray as xr
xr.open_datatree({ms!r}, engine="xarray-ms:msv2", auto_corrs=True).to_zarr({store!r})
"""


def converted(script: str, ms: Path, scheme: tuple[str, ...] = ()) -> Path:
    """Run a script in a process of its own: arcae, which both use, brings another casacore."""
    store = ms.parent / f"{ms.name}.ps.zarr"
    code = textwrap.dedent(script).format(ms=str(ms), store=str(store), scheme=list(scheme))
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, timeout=300)
    return store


@pytest.fixture(params=[XRADIO, XARRAY_MS], ids=["xradio", "xarray-ms"])
def script(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.mark.parametrize("is_averaged", [False, True])
def test_a_simulated_set_is_the_same_in_both_versions(
    tmp_path: Path, script: str, is_averaged: bool
) -> None:
    ms = written(tmp_path, is_averaged=is_averaged)
    store = Msv4Store(converted(script, ms))
    assert_same(store, MeasurementSet(ms))
    assert store.notices() == ()
    assert store.uvw_agrees() is True
    assert store.header.extent == MeasurementSet(ms).header.extent
    (content,), (expected,) = inspect(store.path).fields, inspect(ms).fields
    assert content.name == expected.name
    assert content.counts == expected.counts
    assert content.noise == expected.noise
    assert inspect(store.path).telescope == inspect(ms).telescope


def test_missing_rows_are_no_rows(tmp_path: Path, script: str) -> None:
    ms = with_rows(written(tmp_path), np.random.default_rng(2).choice(1680, 780, replace=False))
    assert_same(Msv4Store(converted(script, ms)), MeasurementSet(ms))


def test_flags_and_weights_that_are_none_are_counted_alike(tmp_path: Path, script: str) -> None:
    ms = written(tmp_path)
    change(ms, "FLAG", True, rows=slice(0, 100))
    change(ms, "DATA", np.nan, rows=slice(100, 200))
    change(ms, "WEIGHT_SPECTRUM", 0.0, rows=slice(200, 300))
    (content,), (expected,) = inspect(converted(script, ms)).fields, inspect(ms).fields
    assert content.counts == expected.counts


@pytest.mark.parametrize("scheme", [(), ("FIELD_ID",), ("SCAN_NUMBER",)])
def test_fields_are_chosen_alike(tmp_path: Path, scheme: tuple[str, ...]) -> None:
    ms = written(tmp_path)
    change(ms, "FIELD_ID", 1, rows=slice(0, 280))
    change(ms, "SCAN_NUMBER", 2, rows=slice(560, 840))
    with tables.table(f"{ms}::FIELD", readonly=False, ack=False) as fields:
        fields.addrows(1)
        fields.putcell("NAME", 1, "calibrator")
        fields.putcell("SOURCE_ID", 1, -1)
        for name in ("PHASE_DIR", "DELAY_DIR", "REFERENCE_DIR"):
            fields.putcell(name, 1, fields.getcell(name, 0) + 0.01)
    store = converted(XRADIO, ms, scheme)
    for wanted in ("simulated", "calibrator", 0, 1):
        assert_same(Msv4Store(store, field=wanted), MeasurementSet(ms, field=wanted))
    scans = {"field": "simulated", "scans": (2,)}
    assert_same(Msv4Store(store, **scans), MeasurementSet(ms, **scans))


def test_windows_are_partitions(tmp_path: Path) -> None:
    coverage, rng = simulated().coverage, np.random.default_rng(1)
    windows = [
        Window(Channels.from_band(low, high, count), rng.normal(size=(len(coverage), count)) + 0j)
        for low, high, count in ((1.0e9, 1.1e9, 3), (1.2e9, 1.3e9, 2))
    ]
    ms = write_varied(tmp_path / "varied.ms", coverage, windows, by_baseline=True)
    with tables.table(f"{ms}::ANTENNA", readonly=False, ack=False) as antennas:
        antennas.putcol("NAME", list(coverage.layout.antenna_names))
    with tables.table(f"{ms}::SPECTRAL_WINDOW", readonly=False, ack=False) as spectral:
        # The band of an average is not kept, and is taken to be the width of the channel.
        for row in range(2):
            spectral.putcell("EFFECTIVE_BW", row, spectral.getcell("CHAN_WIDTH", row))
    store, expected = Msv4Store(converted(XRADIO, ms)), MeasurementSet(ms)
    assert [len(one) for one in store.spectral_windows] == [3, 2]
    assert_same(store, expected)


def test_baseline_dependent_averages_are_a_grid_with_gaps(tmp_path: Path, script: str) -> None:
    ms = averaged_by_baseline(tmp_path)
    store = Msv4Store(converted(script, ms))
    assert len(store.header.partitions[0].timeline) == 90
    assert_same(store, MeasurementSet(ms))


@pytest.mark.real
@pytest.mark.parametrize(
    ("script", "archive"),
    [
        (XRADIO, "day2_TDEM0003_10s_norx_1src_1spw.ms.tar.gz"),
        (XARRAY_MS, "day2_TDEM0003_10s_norx_1src_1spw.ms.tar.gz"),
        (XRADIO, "tDish.MS.tgz"),
        (XARRAY_MS, "tDish.MS.tgz"),
        (XRADIO, "tOSKAR.in_MS.tgz"),  # xarray-ms cannot open it: its table FEED is empty
    ],
)
def test_real_sets_are_the_same_in_both_versions(tmp_path: Path, script: str, archive: str) -> None:
    ms = real_set(tmp_path, archive)
    store, expected = converted(script, ms), MeasurementSet(ms, heeds_flags=False)
    found = Msv4Store(store, heeds_flags=False)
    # Antennas are numbered otherwise: only those that have data are described.
    first, second = rows_of(found), rows_of(expected)
    for rows, observation in ((first, found), (second, expected)):
        diameters = observation.dish_diameters()
        rows["diameters"] = diameters[rows.pop("antennas")]
    for name, values in second.items():
        np.testing.assert_array_equal(first[name], values, err_msg=name)
    assert found.phase_centre == expected.phase_centre
    assert found.uvw_agrees() is expected.uvw_agrees()
    (content,), (other,) = inspect(store).fields, inspect(ms).fields
    assert content.name == other.name
    assert content.counts == other.counts
