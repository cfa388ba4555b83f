"""Columns of other storage managers than those that casacore uses by itself: compressed, or unknown here."""

from pathlib import Path

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import written
from uvshear.errors import InputError
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.measurement_set.opening import casacore_errors
from uvshear.io.observations import inspect

DYSCO = {
    "dataBitCount": 10,
    "weightBitCount": 12,
    "distribution": "TruncatedGaussian",
    "normalization": "AF",
    "studentTNu": 0.0,
    "distributionTruncation": 2.5,
}
"""What DP3 asks of Dysco by default."""


def _stored(path, target, manager, columns, specification):
    """Copy a set with some columns in another storage manager."""
    with tables.table(str(path), ack=False) as main:
        description, managers = main.getdesc(), main.getdminfo()
        kept = {k: one for k, one in managers.items() if not set(one["COLUMNS"]) & set(columns)}
        for column in columns:
            shape = list(main.getcell(column, 0).shape)
            description[column] |= {"option": 5, "shape": shape, "ndim": len(shape)}
            description[column] |= {"dataManagerType": manager, "dataManagerGroup": column}
            kept[column] = {
                "TYPE": manager,
                "NAME": column,
                "COLUMNS": [column],
                "SPEC": specification,
            }
        with tables.table(
            str(target), description, dminfo=kept, nrow=main.nrows(), ack=False
        ) as copied:
            for name in main.colnames():
                if main.isvarcol(name) and not main.iscelldefined(name, 0):
                    continue
                copied.putcol(name, main.getcol(name))
            for name in main.keywordnames():
                copied.putkeyword(name, main.getkeyword(name))
            stored = {c: one["TYPE"] for one in copied.getdminfo().values() for c in one["COLUMNS"]}
    assert [stored[column] for column in columns] == [manager] * len(columns)
    return target


def _seen(path):
    chunks = list(MeasurementSet(path).chunks())
    return tuple(
        np.concatenate([getattr(chunk, name) for chunk in chunks])
        for name in ("stokes_i", "weights")
    )


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return written(tmp_path_factory.mktemp("plain"))


def test_visibilities_that_dysco_compressed_are_read(path, tmp_path):
    compressed = _stored(
        path, tmp_path / "dysco.ms", "DyscoStMan", ["DATA", "WEIGHT_SPECTRUM"], DYSCO
    )
    visibilities, weights = _seen(path)
    found, found_weights = _seen(compressed)
    np.testing.assert_allclose(found_weights, weights, rtol=1e-4)
    in_noise = np.abs(found - visibilities) * np.sqrt(weights)
    # 0.0046; Dysco dithers with numbers that no seed determines. Rows that are mixed up make 1.4.
    assert 0 < np.sqrt(np.mean(in_noise**2)) < 0.01


def test_visibilities_that_sisco_compressed_are_the_same(path, tmp_path):
    compressed = _stored(path, tmp_path / "sisco.ms", "SiscoStMan", ["DATA"], {})
    for found, expected in zip(_seen(compressed), _seen(path), strict=True):
        np.testing.assert_array_equal(found, expected)


def _renamed(path, before, after):
    """Let table.dat name another storage manager, of as many letters."""
    content = (path / "table.dat").read_bytes()
    assert before in content
    (path / "table.dat").write_bytes(content.replace(before, after))


def test_a_storage_manager_that_is_not_there_is_named(path, tmp_path):
    copied = _stored(path, tmp_path / "unknown.ms", "SiscoStMan", ["DATA"], {})
    _renamed(copied, b"SiscoStMan", b"CubicStMan")
    told = []
    for function in (MeasurementSet, inspect):
        with pytest.raises(InputError) as error:
            function(copied)
        told.append(str(error.value))
    assert told[0] == told[1]
    assert "\n" not in told[0]
    assert "CubicStMan, a storage manager that is not part of this casacore" in told[0]
    assert "msout.storagemanager=" in told[0]


def test_a_storage_manager_without_its_class_is_named():
    """casacore says so where it has the library, but not the class."""
    with (
        pytest.raises(InputError, match="columns in OddStMan, a storage manager"),
        casacore_errors(Path("odd.ms"), "the main table"),
    ):
        raise RuntimeError(
            "Table DataManager error: Data Manager class OddStMan is not registered\n  Check (DY)LD_LIBRARY_PATH"
        )
