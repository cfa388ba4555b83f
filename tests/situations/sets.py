"""Measurement Sets as programs of others leave them."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
from casacore import tables

from tests.io.measurement_sets import change, edited, emptied
from tests.situations.situation import SAME, Expected, Files, Situation, noted, refused

CODES = {"TabRefTypes": ["J2000", "B1950", "ICRS"], "TabRefCodes": np.array([0, 4, 21], np.uint32)}


def _row(path: Path, subtable: str, **cells: object) -> int:
    """Add a copy of the first row, with other cells, and return its number."""
    with edited(path, subtable) as table:
        row = table.nrows()
        table.addrows(1)
        for name in table.colnames():
            if table.iscelldefined(name, 0):
                table.putcell(name, row, cells.get(name, table.getcell(name, 0)))
        return row


def _every_other(path: Path, column: str, value: int) -> None:
    with edited(path) as main:
        numbers = main.getcol(column)
        numbers[::2] = value
        main.putcol(column, numbers)


def _cells(path: Path, subtable: str, column: str, value: object, kind: str, ndim: int) -> None:
    """Replace a column by one with cells of another shape."""
    with edited(path, subtable) as table:
        rows = table.nrows()
        table.removecols(column)
        example = {"double": 0.0, "complex": 0j, "float": 0.0}[kind]
        made = tables.makearrcoldesc(column, example, ndim=ndim, valuetype=kind)
        table.addcols(tables.maketabdesc([made]))
        for row in range(rows):
            table.putcell(column, row, value)


def selection(files: Files) -> None:
    """A selection of rows, as taql or CASA's split by reference writes it, refers to the subtables of its parent."""
    whole = files.directory / "whole.ms"
    files.field.rename(whole)
    with tables.table(str(whole), ack=False) as main:
        main.query("ROWNUMBER() >= 0", name=str(files.field)).close()


def concatenation(files: Files) -> None:
    """Halves of the rows, put together virtually (CASA's multi-MS, virtualconcat)."""
    halves = []
    with tables.table(str(files.field), ack=False) as main:
        middle = main.nrows() // 2
        for number, rows in enumerate((range(middle), range(middle, main.nrows()))):
            halves.append(str(files.directory / f"half{number}.ms"))
            main.selectrows(list(rows)).copy(halves[-1], deep=True).close()
    shutil.rmtree(files.field)
    tables.msconcat(halves, str(files.field))


def frames_by_row(files: Files) -> None:
    """Directions whose frame is in a column, as importasdm writes it (all sets of ALMA)."""
    with edited(files.field, "FIELD") as fields:
        fields.addcols(tables.maketabdesc([tables.makescacoldesc("PhaseDir_Ref", 0)]))
        fields.putcol("PhaseDir_Ref", np.full(fields.nrows(), 21, np.int32))
        info = dict(fields.getcolkeyword("PHASE_DIR", "MEASINFO"))
        info.pop("Ref", None)
        fields.putcolkeyword("PHASE_DIR", "MEASINFO", info | {"VarRefCol": "PhaseDir_Ref"} | CODES)


def frames_of_1950(files: Files) -> None:
    """The same, in a frame that is not that of the UVW."""
    frames_by_row(files)
    change(files.field, "PhaseDir_Ref", 4, subtable="FIELD")


def unused_description(files: Files) -> None:
    """Rows of DATA_DESCRIPTION, SPECTRAL_WINDOW and POLARIZATION that no visibility has, the last one not filled."""
    window = _row(files.field, "SPECTRAL_WINDOW", CHAN_FREQ=np.zeros(4), CHAN_WIDTH=np.zeros(4))
    hands = _row(files.field, "POLARIZATION", NUM_CORR=1, CORR_TYPE=np.array([10], np.int32))
    _row(files.field, "DATA_DESCRIPTION", SPECTRAL_WINDOW_ID=window)
    _row(files.field, "DATA_DESCRIPTION", POLARIZATION_ID=hands)
    with edited(files.field, "SPECTRAL_WINDOW") as windows:
        windows.addrows(1)


def dangling(column: str, number: int) -> Callable[[Files], None]:
    """Rows that refer to a number which the subtable does not have."""
    return lambda files: _every_other(files.field, column, number)


def dangling_below(subtable: str, column: str, number: int) -> Callable[[Files], None]:
    """A description that refers to a row which its subtable does not have."""
    return lambda files: change(files.field, column, number, subtable=subtable)


def unused_numbers(files: Files) -> None:
    """Rows of FIELD, ANTENNA and SOURCE to which nothing refers, with nonsense in them."""
    _row(files.field, "FIELD", NAME="", PHASE_DIR=np.full((1, 2), np.nan))
    _row(files.field, "ANTENNA", NAME="", POSITION=np.zeros(3), DISH_DIAMETER=-1.0)


def field_twice(north: float) -> Callable[[Files], None]:
    """Two rows of FIELD of one name (after concatenation), the second farther North [rad]."""

    def make(files: Files) -> None:
        with tables.table(str(files.field / "FIELD"), ack=False) as fields:
            direction = fields.getcell("PHASE_DIR", 0)
        row = _row(files.field, "FIELD", PHASE_DIR=direction + np.array([[0, north]]))
        _every_other(files.field, "FIELD_ID", row)

    return make


def field_name(name: str) -> Callable[[Files], list[str]]:
    """A field of some name, chosen by it, beside another field without rows."""

    def make(files: Files) -> list[str]:
        with edited(files.field, "FIELD") as fields:
            fields.putcell("NAME", 0, name)
        _row(files.field, "FIELD", NAME="other")
        return ["--field", name.strip()]

    return make


def ephemeris(files: Files) -> None:
    """A field that follows a body of the solar system."""
    with edited(files.field, "FIELD") as fields:
        fields.addcols(tables.maketabdesc([tables.makescacoldesc("EPHEMERIS_ID", 0)]))
        fields.putcol("EPHEMERIS_ID", np.zeros(fields.nrows(), np.int32))


def without_locks(files: Files) -> None:
    """A copy by a program that leaves out the files of locks."""
    for file in files.field.rglob("table.lock"):
        file.unlink()


def without(*names: str) -> Callable[[Files], None]:
    """A set that lacks subtables, with the keywords that refer to them."""

    def make(files: Files) -> None:
        with edited(files.field) as main:
            for name in names:
                main.removekeyword(name)
        for name in names:
            shutil.rmtree(files.field / name)

    return make


def without_folder(name: str) -> Callable[[Files], None]:
    """A set of which the folder of a subtable is lost, although it refers to it."""
    return lambda files: shutil.rmtree(files.field / name)


def without_columns(subtable: str, *columns: str) -> Callable[[Files], None]:
    """A table that lacks columns."""

    def make(files: Files) -> None:
        with edited(files.field, subtable) as table:
            for column in columns:
                table.removecols(column)

    return make


def cells(
    subtable: str, column: str, value: object, kind: str = "double", ndim: int = 1
) -> Callable[[Files], None]:
    """A column whose cells have another shape."""
    return lambda files: _cells(files.field, subtable, column, value, kind, ndim)


def values(
    column: str, value: object, subtable: str = "", rows: slice | None = None
) -> Callable[[Files], None]:
    """A column with other values."""
    return lambda files: change(files.field, column, value, rows, subtable)


def no_exposure(files: Files) -> None:
    """An EXPOSURE that nobody filled, beside the right INTERVAL."""
    change(files.field, "EXPOSURE", 0.0)


def no_times(files: Files) -> None:
    """Rows without a time."""
    for column in ("TIME", "TIME_CENTROID"):
        change(files.field, column, np.nan, slice(7, 9))


def zero_baselines(files: Files) -> None:
    """Rows at the end of which only the times were filled."""
    with edited(files.field) as main:
        first = main.nrows()
        main.addrows(5)
        for name in main.colnames():
            if main.iscelldefined(name, 0):
                for row in range(first, first + 5):
                    main.putcell(name, row, main.getcell(name, 0))
    change(files.field, "UVW", 0.0, slice(first, None))


def longer_baseline(files: Files) -> None:
    """A row whose UVW the array could have, but not between the two antennas of the row."""
    with edited(files.field) as main:
        uvw = main.getcol("UVW")
        lengths = np.linalg.norm(uvw, axis=1)
        row = int(np.argmin(np.abs(lengths - 0.4 * lengths.max())))
        main.putcell("UVW", row, 2 * uvw[row])


def equal_antennas(files: Files) -> None:
    """Rows whose second antenna is lost."""
    with edited(files.field) as main:
        for row in (10, 50, 90):
            main.putcell("ANTENNA2", row, main.getcell("ANTENNA1", row))


def unwritten(files: Files) -> None:
    """Rows at the end that an interrupted program has added and not filled."""
    with edited(files.field) as main:
        main.addrows(7)


def shuffled(files: Files) -> None:
    """Rows in any order."""
    with tables.table(str(files.field), ack=False) as main:
        order = np.random.default_rng(4).permutation(main.nrows())
        main.selectrows(order).copy(str(files.directory / "shuffled.ms"), deep=True).close()
    shutil.rmtree(files.field)
    (files.directory / "shuffled.ms").rename(files.field)


def swapped(files: Files) -> None:
    """Baselines from the second antenna to the first, in every other row."""
    with edited(files.field) as main:
        chosen = slice(None, None, 2)
        first, second = main.getcol("ANTENNA1"), main.getcol("ANTENNA2")
        first[chosen], second[chosen] = second[chosen].copy(), first[chosen].copy()
        uvw, data = main.getcol("UVW"), main.getcol("DATA")
        uvw[chosen] *= -1
        data[chosen] = data[chosen].conj()
        for name, value in (
            ("ANTENNA1", first),
            ("ANTENNA2", second),
            ("UVW", uvw),
            ("DATA", data),
        ):
            main.putcol(name, value)


def unfilled_weights(files: Files) -> None:
    """A WEIGHT_SPECTRUM that was never written, beside a right WEIGHT."""
    with edited(files.field) as main:
        main.removecols("WEIGHT_SPECTRUM")
        made = tables.makearrcoldesc("WEIGHT_SPECTRUM", 0.0, ndim=2, valuetype="float")
        main.addcols(tables.maketabdesc([made]))


def damaged(name: str) -> Callable[[Files], None]:
    """A file of which the first half is overwritten."""

    def make(files: Files) -> None:
        path = files.field / name
        content = bytearray(path.read_bytes())
        half = len(content) // 2
        content[:half] = bytes(half)
        path.write_bytes(bytes(content))

    return make


def truncated(name: str) -> Callable[[Files], None]:
    """A file that ends too early, as after a copy that was cut short."""

    def make(files: Files) -> None:
        path = files.field / name
        path.write_bytes(path.read_bytes()[:40])

    return make


def unknown_manager(files: Files) -> None:
    """Visibilities compressed by a program that is not installed."""
    path = files.field / "table.dat"
    content = path.read_bytes()
    assert content.count(b"TiledColumnStMan") > 0
    path.write_bytes(content.replace(b"TiledColumnStMan", b"SiscoMightyStMan"))


def read_only(files: Files) -> None:
    """A set in which nothing may be written."""
    for path in files.field.rglob("*"):
        path.chmod(0o555 if path.is_dir() else 0o444)


def no_rows(files: Files) -> None:
    """A set without rows."""
    with tables.table(str(files.field), ack=False) as main:
        main.query("False").copy(str(files.directory / "empty.ms"), deep=True).close()
    shutil.rmtree(files.field)
    (files.directory / "empty.ms").rename(files.field)


def halves(files: Files) -> list[str]:
    """Two sets of one pointing."""
    with tables.table(str(files.field), ack=False) as main:
        middle = main.nrows() // 2
        rows = np.arange(main.nrows())
        main.selectrows(rows[middle:]).copy(str(files.directory / "late.ms"), deep=True).close()
        main.selectrows(rows[:middle]).copy(str(files.directory / "early.ms"), deep=True).close()
    shutil.rmtree(files.field)
    (files.directory / "early.ms").rename(files.field)
    return [str(files.directory / "late.ms")]


def empty(subtable: str) -> Callable[[Files], None]:
    """A subtable without rows."""
    return lambda files: emptied(files.field, subtable)


ROUNDED = Expected(within=1e-3)
"""Sums in single precision over rows in another order."""

# ``info`` must say of these what ``measure`` says.
_OF_THE_SET = (
    ("a selection of rows by reference", selection, SAME),
    ("sets put together by reference", concatenation, SAME),
    ("frames of directions by row", frames_by_row, SAME),
    ("frames by row that are B1950", frames_of_1950, refused("B1950")),
    ("unused and unfilled descriptions", unused_description, SAME),
    ("unused fields and antennas", unused_numbers, SAME),
    ("a description that is not there", dangling("DATA_DESC_ID", 1), refused("DATA_DESC")),
    ("a negative description", dangling("DATA_DESC_ID", -1), refused("DATA_DESC")),
    ("a field that is not there", dangling("FIELD_ID", 1), refused("FIELD")),
    ("an antenna that is not there", dangling("ANTENNA2", 8), SAME),
    (
        "a window that is not there",
        dangling_below("DATA_DESCRIPTION", "SPECTRAL_WINDOW_ID", 1),
        refused("SPECTRAL_WINDOW"),
    ),
    (
        "a polarisation that is not there",
        dangling_below("DATA_DESCRIPTION", "POLARIZATION_ID", 1),
        refused("POLARIZATION"),
    ),
    ("one field in two rows", field_twice(0.0), noted("one name, simulated, and one phase centre")),
    ("a field whose name begins with 0", field_name("0137"), SAME),
    ("a field whose name is a number", field_name("137"), SAME),
    ("a field whose name ends in blanks", field_name("M 31  "), SAME),
    ("a field on an ephemeris", ephemeris, refused("EPHEMERIS_ID")),
    ("no files of locks", without_locks, SAME),
    (
        "no informational subtables",
        without("HISTORY", "FLAG_CMD", "POINTING", "PROCESSOR", "STATE", "OBSERVATION", "FEED"),
        SAME,
    ),
    ("no SPECTRAL_WINDOW", without("SPECTRAL_WINDOW"), refused("SPECTRAL_WINDOW")),
    ("the folder of FIELD is lost", without_folder("FIELD"), refused("FIELD")),
    ("the folder of HISTORY is lost", without_folder("HISTORY"), SAME),
    ("no rows in FIELD", empty("FIELD"), refused("FIELD is empty")),
    ("no rows in OBSERVATION", empty("OBSERVATION"), SAME),
    (
        "no informational columns",
        without_columns("", "TIME_CENTROID", "FLAG_CATEGORY"),
        SAME,
    ),
    ("no UVW", without_columns("", "UVW"), refused("UVW")),
    ("no DATA", without_columns("", "DATA"), refused("DATA")),
    (
        "CHAN_WIDTH of another shape than CHAN_FREQ",
        cells("SPECTRAL_WINDOW", "CHAN_WIDTH", np.full(2, 6e7)),
        refused("CHAN_WIDTH"),
    ),
    (
        "PHASE_DIR of one number",
        cells("FIELD", "PHASE_DIR", np.zeros((1, 1)), ndim=2),
        refused("PHASE_DIR"),
    ),
    ("an empty POSITION", cells("ANTENNA", "POSITION", np.zeros(0)), SAME),
    ("EXPOSURE 0 beside INTERVAL", no_exposure, SAME),
    ("an infinite EXPOSURE", values("EXPOSURE", np.inf, rows=slice(7, 9)), noted("left out", 0.3)),
    ("a TIME that is NaN", values("TIME", np.nan, rows=slice(7, 9)), SAME),
    ("neither TIME nor TIME_CENTROID", no_times, noted("left out", 0.3)),
    ("rows with UVW = 0", zero_baselines, noted("left out|UVW", 1e-3)),
    ("one UVW of 1e20 m", values("UVW", 1e20, rows=slice(7, 8)), noted("left out", 0.3)),
    ("one UVW of twice its length", longer_baseline, noted("as the distance between", 0.3)),
    (
        "rows with two equal antennas",
        equal_antennas,
        noted("two equal antennas but a UVW that is not zero is 3", 0.3),
    ),
    ("rows that were never written", unwritten, refused("no value in 7 rows")),
    ("rows in any order", shuffled, ROUNDED),
    ("baselines both ways", swapped, ROUNDED),
    ("a WEIGHT_SPECTRUM that was never written", unfilled_weights, SAME),
    ("a damaged FIELD", damaged("FIELD/table.dat"), refused("FIELD")),
    ("a damaged main table", damaged("table.dat"), refused("field.ms")),
    ("a FIELD cut short", truncated("FIELD/table.dat"), refused("FIELD")),
    ("an unknown storage manager", unknown_manager, refused("SiscoMighty")),
    ("a set that may only be read", read_only, SAME),
)

_OF_THE_MEASUREMENT = (
    ("two fields of one name", field_twice(1e-3), refused("several fields, 0 .*, 1")),
    ("all rows flagged", values("FLAG_ROW", True), refused("flag")),
    ("no rows", no_rows, refused("no rows")),
    ("two sets of one pointing", halves, SAME),
)

SITUATIONS = (
    *(Situation(*each, informs=True) for each in _OF_THE_SET),
    *(Situation(*each) for each in _OF_THE_MEASUREMENT),
)
