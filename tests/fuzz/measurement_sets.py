"""Measurement Sets, mutated by value, cell, column, subtable and byte."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
from casacore import tables

from tests.fuzz.case import Kind, Reading
from tests.fuzz.valid_sets import is_another_valid_set
from tests.fuzz.wild import WILD_WHOLE, damage, wild_number, with_flipped_bit, word

SUBTABLES: Final = (
    *("ANTENNA", "FIELD", "SPECTRAL_WINDOW", "POLARIZATION", "DATA_DESCRIPTION", "OBSERVATION"),
    *("FEED", "STATE", "POINTING", "HISTORY", "PROCESSOR", "FLAG_CMD"),
)
READ: Final = {
    "": (
        *("DATA", "DATA", "UVW", "UVW", "FLAG", "WEIGHT_SPECTRUM", "WEIGHT", "SIGMA", "TIME"),
        *("INTERVAL", "EXPOSURE", "ANTENNA1", "ANTENNA2", "DATA_DESC_ID", "FIELD_ID", "FLAG_ROW"),
        *("SCAN_NUMBER", "TIME_CENTROID"),
    ),
    "FIELD": ("PHASE_DIR", "REFERENCE_DIR", "DELAY_DIR", "NAME", "NUM_POLY"),
    "SPECTRAL_WINDOW": (
        *("CHAN_FREQ", "CHAN_WIDTH", "EFFECTIVE_BW", "NUM_CHAN", "REF_FREQUENCY", "RESOLUTION"),
        "TOTAL_BANDWIDTH",
    ),
    "POLARIZATION": ("CORR_TYPE", "NUM_CORR", "CORR_PRODUCT"),
    "DATA_DESCRIPTION": ("SPECTRAL_WINDOW_ID", "POLARIZATION_ID", "FLAG_ROW"),
    "ANTENNA": ("POSITION", "DISH_DIAMETER", "NAME"),
    "OBSERVATION": ("TELESCOPE_NAME", "TIME_RANGE"),
}
"""Columns that hold what a measurement depends on, and some that repeat it."""

OF_AVERAGES: Final = ("UVSHEAR_FREQUENCY", "UVSHEAR_WIDTH", "UVSHEAR_SECOND", "UVSHEAR_FOURTH")
"""Columns that averages over cells have besides."""


class MeasurementSets(Kind):
    """Measurement Sets, which `info` and `measure` read."""

    variants = ("field.ms", "field.ms", "windows.ms", "averages.ms")

    def mutate(self, clean: Path, variant: str, path: Path, rng: np.random.Generator) -> str:
        """Mutate once, or in some cases twice."""
        done = [_mutated(path, rng)]
        if rng.random() < 0.15:
            done.append(_mutated(path, rng))
        return "; ".join(done)

    def readings(self, clean: Path, variant: str, path: Path) -> tuple[Reading, ...]:
        """Return the commands."""
        shapes = path.with_name("shapes.fits")
        return (
            Reading(("info", str(path))),
            Reading(
                (
                    *("measure", str(path), "--catalogue", str(clean / "cat.ecsv")),
                    *("--threads", "1", "-o", str(shapes)),
                ),
                shapes,
            ),
        )

    def is_valid(self, clean: Path, variant: str, path: Path) -> bool:
        """Compare what the sets contain."""
        return is_another_valid_set(path, clean / variant)


def _mutated(path: Path, rng: np.random.Generator) -> str:
    ways: tuple[Callable[[Path, np.random.Generator], str], ...] = (
        *(_of_value, _of_value, _of_value, _of_cell, _of_cell, _of_column, _of_column),
        *(_of_subtable, _of_bytes, _of_bytes, _of_bytes),
    )
    while True:
        try:
            return ways[rng.integers(len(ways))](path, rng)
        except (RuntimeError, ValueError, TypeError, OSError, OverflowError):
            continue  # casacore refuses to do this, or an earlier mutation prevents it


def _drawn_column(path: Path, rng: np.random.Generator) -> tuple[str, str]:
    names = ("", "", *READ)
    table = names[rng.integers(len(names))]
    columns = READ[table]
    if not table and path.name == "averages.ms" and rng.integers(2):
        columns = OF_AVERAGES
    return table, columns[rng.integers(len(columns))]


def _opened(path: Path, table: str) -> tables.table:
    return tables.table(str(path / table), readonly=False, ack=False)


def _of_value(path: Path, rng: np.random.Generator) -> str:
    """Change one number of some rows."""
    table, column = _drawn_column(path, rng)
    with _opened(path, table) as opened:
        rows = _rows(opened.nrows(), rng)
        value = np.array(opened.getcell(column, rows[0]))
        place = tuple(int(rng.integers(size)) for size in value.shape)
        new = _wild(rng, value[place])
        for row in rows:
            value = np.array(opened.getcell(column, row))
            value[place] = new
            opened.putcell(column, row, value if value.shape else value.item())
    return f"{table}::{column}{list(place)} = {new!r} in {_said(rows)}"


def _rows(count: int, rng: np.random.Generator) -> list[int]:
    first = int(rng.integers(count))
    choices = ([first], [first], list(range(first, min(first + 7, count))), list(range(count)))
    return choices[rng.integers(len(choices))]


def _said(rows: list[int]) -> str:
    return f"row {rows[0]}" if len(rows) == 1 else f"rows {rows[0]} to {rows[-1]}"


def _wild(rng: np.random.Generator, value: Any) -> Any:
    kind = np.asarray(value).dtype.kind
    if kind == "b":
        return not value
    if kind in "iu":
        return int(rng.choice([*WILD_WHOLE, value + 1, value - 1]))
    if kind in "US":
        return word(rng)
    if kind == "c" and rng.integers(2):
        return complex(wild_number(rng, value.real), wild_number(rng, value.imag))
    if kind in "cf" and rng.integers(2):
        return with_flipped_bit(rng, value).item()
    return wild_number(rng, value.real)


def _of_cell(path: Path, rng: np.random.Generator) -> str:
    """Replace a cell by one of another shape, or of one value."""
    table, column = _drawn_column(path, rng)
    with _opened(path, table) as opened:
        rows = _rows(opened.nrows(), rng)
        value = np.array(opened.getcell(column, rows[0]))
        if value.ndim == 0 or rng.integers(2):
            new = np.full(value.shape, _wild(rng, value.flat[0]), value.dtype)
        else:
            shapes = [(), (0,), (1,), (2,), value.shape[::-1], (*value.shape, 1), (1, *value.shape)]
            shapes += [tuple(size + 1 for size in value.shape), (3, 2), (1, 1), value.shape[1:]]
            shape = shapes[rng.integers(len(shapes))] or (1,)
            new = np.resize(value, shape).astype(value.dtype)
        for row in rows:
            opened.putcell(column, row, new if new.shape else new.item())
    return f"{table}::{column} = {np.array2string(new, threshold=4)} of shape {new.shape} in {_said(rows)}"


def _of_column(path: Path, rng: np.random.Generator) -> str:
    """Remove, rename, retype, shuffle or fill a column, or change its keywords."""
    table, column = _drawn_column(path, rng)
    with _opened(path, table) as opened:
        choice = rng.integers(6)
        if choice == 0:
            opened.removecols(column)
            return f"{table}::{column} removed"
        if choice == 1:
            opened.renamecol(column, f"{column}_OLD")
            return f"{table}::{column} renamed"
        if choice == 2:
            kinds = (
                ("float", 0.0),
                ("int", 0),
                ("string", ""),
                ("boolean", False),
                ("dcomplex", 0j),
            )
            kind, example = kinds[rng.integers(len(kinds))]
            ndim = int(rng.integers(3))
            opened.renamecol(column, f"{column}_OLD")
            description = (
                tables.makearrcoldesc(column, example, ndim=ndim, valuetype=kind)
                if ndim
                else tables.makescacoldesc(column, example, valuetype=kind)
            )
            opened.addcols(tables.maketabdesc(description))
            if rng.integers(2):
                cell = np.full([2] * ndim, example) if ndim else example
                for row in range(opened.nrows()):
                    opened.putcell(column, row, cell)
            return f"{table}::{column} is of {kind} in {ndim} dimensions"
        if choice == 3:
            cells = [opened.getcell(column, row) for row in range(opened.nrows())]
            for row, place in enumerate(rng.permutation(len(cells))):
                opened.putcell(column, row, cells[place])
            return f"{table}::{column} shuffled"
        if choice == 4:
            keywords = opened.getcolkeywords(column)
            if not keywords:
                raise ValueError(column)
            name = sorted(keywords)[rng.integers(len(keywords))]
            new = [word(rng), {"Ref": word(rng)}, {"VarRefCol": word(rng)}, np.array([1, 2])][
                rng.integers(4)
            ]
            opened.removecolkeyword(column, name)
            opened.putcolkeyword(column, name, new)
            return f"keyword {name} of {table}::{column} is {new!r}"
        value = np.array(opened.getcell(column, 0))
        new = _wild(rng, value.flat[0])
        for row in range(opened.nrows()):
            filled = np.full(np.shape(opened.getcell(column, row)), new, value.dtype)
            opened.putcell(column, row, filled if filled.shape else filled.item())
        return f"{table}::{column} filled with {new!r}"


def _of_subtable(path: Path, rng: np.random.Generator) -> str:  # noqa: PLR0911 - one return for each way
    """Remove, empty, cut, repeat, swap or unlink a subtable."""
    name = SUBTABLES[rng.integers(len(SUBTABLES))]
    choice = rng.integers(7)
    if choice == 0:
        shutil.rmtree(path / name)
        return f"{name} removed"
    if choice == 1:
        with _opened(path, "") as main:
            main.removekeyword(name)
        return f"the keyword {name} removed"
    if choice == 2:
        other = SUBTABLES[rng.integers(len(SUBTABLES))]
        if other == name:
            raise ValueError(name)
        shutil.rmtree(path / name)
        shutil.copytree(path / other, path / name)
        return f"{name} is a copy of {other}"
    if choice == 3:
        with _opened(path, "") as main:
            new = [word(rng), 7, f"Table: {path}/NO_SUCH_TABLE", f"Table: {path}/FEED"][
                rng.integers(4)
            ]
            main.putkeyword(name, new)
        return f"the keyword {name} is {new}"
    if choice == 4:
        with _opened(path, name) as opened:
            count = opened.nrows()
            opened.addrows(int(rng.integers(1, 4)))
        return f"rows without values after the {count} of {name}"
    if choice == 5:
        with tables.table(str(path / name), ack=False) as opened:
            description, count = opened.getdesc(), opened.nrows()
        rows = int(rng.integers(0, 2)) * count
        shutil.rmtree(path / name)
        tables.table(str(path / name), description, nrow=rows, ack=False).close()
        return f"{name} has {rows} rows without values"
    with _opened(path, "") as main:
        count = main.nrows()
        if rng.integers(2):
            main.addrows(int(rng.integers(1, 30)))
            return f"rows without values after the {count} of the main table"
        rows = rng.permutation(count)[: int(rng.integers(1, count))]
        main.removerows(sorted(rows.tolist()))
        return f"{len(rows)} rows removed"


def _of_bytes(path: Path, rng: np.random.Generator) -> str:
    """Damage, remove or exchange a file."""
    files = sorted(file for file in path.rglob("*") if file.is_file())
    # Half of the time one of the files that hold the visibilities and their description.
    main = [file for file in files if file.parent == path]
    chosen = main if rng.integers(2) else files
    file = chosen[rng.integers(len(chosen))]
    name = file.relative_to(path)
    choice = rng.integers(8)
    if choice == 0:
        file.unlink()
        return f"{name} removed"
    if choice == 1:
        other = files[rng.integers(len(files))]
        shutil.copy(other, file)
        return f"{name} is a copy of {other.relative_to(path)}"
    return f"{name}: {damage(rng, file)}"
