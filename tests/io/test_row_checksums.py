"""Checksums of rows, through files."""

from pathlib import Path

import numpy as np
import pytest
from astropy.table import MaskedColumn, Table

from uvshear.io.row_checksums import CHECKSUM, changed_rows, checksums


@pytest.fixture
def table() -> Table:
    arrays = np.empty(3, object)
    arrays[:] = [np.arange(3.0, dtype=np.float32), np.zeros(0, np.float32), np.ones(2, np.float32)]
    found = Table(
        {
            "id": ["a", "bcd", "e"],
            "flag": ["ok", "too_large", "ok"],
            "number": [1.5, np.nan, -0.1],
            "count": [7, 0, -3],
            "pair": [[0.1, 0.2], [0.0, np.nan], [1e300, -1e-300]],
            "array": arrays,
        }
    )
    found[CHECKSUM] = checksums(found)
    return found


def _through(table: Table, path: Path) -> Table:
    table.write(path, overwrite=True)
    return Table.read(path)


@pytest.mark.parametrize("name", ["t.fits", "t.ecsv"])
def test_a_file_keeps_the_checksums(tmp_path: Path, table: Table, name: str) -> None:
    assert not changed_rows(table).any()
    written = table.copy()
    if name != "t.fits":
        del written["array"]
        written[CHECKSUM] = checksums(written[written.colnames[:-1]])
    assert not changed_rows(_through(written, tmp_path / name)).any()


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("id", "bcf"),
        ("flag", "ok"),
        ("number", 0.0),
        ("count", 1),
        ("pair", [0.0, 0.0]),
        ("array", np.zeros(1, np.float32)),
        (CHECKSUM, 5),
    ],
)
def test_a_cell_that_was_changed_is_found(
    tmp_path: Path, table: Table, column: str, value: object
) -> None:
    table[column][1] = value
    assert changed_rows(_through(table, tmp_path / "t.fits")).tolist() == [False, True, False]


def test_a_flipped_bit_is_found(table: Table) -> None:
    bits = table["number"].view(np.int64)
    bits[2] ^= 1
    assert changed_rows(table).tolist() == [False, False, True]


def test_rows_may_be_selected_and_sorted_and_columns_added(tmp_path: Path, table: Table) -> None:
    chosen = _through(table, tmp_path / "t.fits")[[2, 0]]
    chosen["note"] = ["mine", "mine"]
    assert not changed_rows(_through(chosen, tmp_path / "c.fits")).any()


def test_a_column_that_was_removed_or_a_checksum_that_was_masked_is_found(table: Table) -> None:
    assert changed_rows(table[["id", "flag", CHECKSUM]]).all()
    table[CHECKSUM] = MaskedColumn(table[CHECKSUM], mask=[True, False, False])
    assert changed_rows(table).tolist() == [True, False, False]
    table[CHECKSUM] = np.zeros((3, 2))
    assert changed_rows(table).all()


def test_a_table_without_checksums_is_not_checked(table: Table) -> None:
    assert not changed_rows(table[["id", "number"]]).any()
