"""Mutations of tables in files: of text, of FITS and of VOTables, by cell, column, row, unit, metadata and byte."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
from astropy.io import fits
from astropy.table import MaskedColumn, Table

from tests.fuzz.wild import damage, wild_number, with_flipped_bit, word

UNITS: Final = ("", "deg", "rad", "arcsec", "Jy", "uJy", "mJy", "mag", "Hz", "K km / s", "furlong")

FORMATS: Final = {
    ".ecsv": "ascii.ecsv",
    ".csv": "ascii.csv",
    ".vot": "votable",
    ".fits": "fits",
    ".srl": "ascii.commented_header",
}
"""Formats of astropy by extension, as written by it and not by the package."""


def read(path: Path) -> Table:
    """Read a table with astropy alone."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if path.suffix == ".srl":
            start = path.read_text().splitlines().index("") - 1
            return Table.read(path, format=FORMATS[".srl"], header_start=start + 1)
        return Table.read(path, format=FORMATS[path.suffix])


def mutate_table(path: Path, rng: np.random.Generator, columns: tuple[str, ...]) -> str:
    """Change a table, and return in words how.

    Parameters
    ----------
    columns
        Columns that are mutated; others are only once in a while.
    """
    if path.suffix == ".fits" and rng.integers(8) == 0:
        return _of_header(path, rng)
    if path.suffix == ".srl" or rng.random() < 0.35:
        is_text = path.suffix != ".fits"
        return _of_text(path, rng) if is_text and rng.integers(2) else damage(rng, path)
    original = path.read_bytes()
    table = read(path)
    ways: tuple[Callable[[Table, str, np.random.Generator], str], ...] = (
        *(_of_cell, _of_cell, _of_cell, _of_column, _of_column, _of_unit, _of_rows, _of_metadata),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        while True:
            names = [name for name in columns if name in table.colnames]
            if rng.random() < 0.1:
                names = table.colnames
            try:
                words = ways[rng.integers(len(ways))](table, names[rng.integers(len(names))], rng)
                table.write(path, format=FORMATS[path.suffix], overwrite=True)
            except Exception:  # astropy refuses what it cannot write in many ways
                path.write_bytes(original)
                table = read(path)
                continue
            return words


def _of_cell(table: Table, name: str, rng: np.random.Generator) -> str:
    row = int(rng.integers(len(table)))
    column = table[name]
    kind = column.dtype.kind
    if kind == "f" and column.ndim == 1:
        old = column[row]
        is_flip = rng.integers(2) and not np.ma.is_masked(old)
        column[row] = with_flipped_bit(rng, old) if is_flip else wild_number(rng, float(old))
    elif kind in "US":
        table[name] = column.astype("U400")
        table[name][row] = word(rng)
    elif kind == "O":
        arrays = list(column)
        array = np.array(arrays[row])
        if array.size and rng.integers(3):
            place = int(rng.integers(array.size))
            array.flat[place] = with_flipped_bit(rng, array.flat[place])
        else:
            array = np.resize(array, int(rng.integers(0, array.size + 5)))
        _put(column, row, array)
        return f"{name}, row {row + 1}: an element, or the number of them ({array.size})"
    else:
        column[row] = int(rng.choice([-1, 0, 1, 7, 2**31 - 1]))
    return f"{name}, row {row + 1} = {str(table[name][row])[:40]!r}"


def _put(column: Any, row: int, array: Any) -> None:
    column[row] = array


def _of_column(table: Table, name: str, rng: np.random.Generator) -> str:  # noqa: PLR0911 - one return for each way
    choice = rng.integers(9)
    column = table[name]
    if choice == 0:
        table.remove_column(name)
        return f"{name} removed"
    if choice == 1:
        new = str(rng.choice([name.upper(), f"{name}_x", "id", "RA", "x" * 100, "e1", "l"]))
        table.rename_column(name, new)
        return f"{name} renamed to {new[:20]}"
    if choice == 2:
        words = [word(rng) if rng.integers(2) else str(cell) for cell in column]
        table[name] = words
        return f"{name} is of text: {words}"
    if choice == 3:
        table[name] = np.stack([np.asarray(column)] * int(rng.integers(1, 4)), axis=1)
        return f"{name} is of arrays"
    if choice == 4:
        mask = rng.random(len(table)) < 0.5
        table[name] = MaskedColumn(column, mask=mask, unit=column.unit)
        return f"{name} is empty in {mask.sum()} rows"
    if choice == 5:
        kind = str(rng.choice(["i4", "i2", "f4", "?", "c16", "u1", "i8"]))
        with np.errstate(all="ignore"):
            table[name] = np.asarray(column).astype(kind)
        return f"{name} is of the type {kind}, without unit"
    if choice == 6:
        table[name] = np.full(len(table), wild_number(rng, 1.0))
        return f"{name} filled with {table[name][0]}"
    if choice == 7:
        order = rng.permutation(len(table))
        table[name][:] = column[order]
        return f"{name} shuffled by {order.tolist()}"
    new = str(rng.choice(["E1", "flux_err", "ID", "shear1", "Profile", "reference_frequency"]))
    table[new] = [word(rng) for _ in table] if rng.integers(2) else np.asarray(column)
    return f"a column {new} like {name}, or of words"


def _of_unit(table: Table, name: str, rng: np.random.Generator) -> str:
    unit = UNITS[rng.integers(len(UNITS))]
    table[name].unit = unit or None
    return f"{name} is in {unit or 'no unit'}"


def _of_rows(table: Table, name: str, rng: np.random.Generator) -> str:
    choice = rng.integers(4)
    if choice == 0:
        table.remove_rows(slice(0, None))
        return "all rows removed"
    if choice == 1:
        row = int(rng.integers(len(table)))
        table.remove_row(row)
        return f"row {row + 1} removed"
    if choice == 2:
        table.add_row(table[int(rng.integers(len(table)))])
        return "a row repeated"
    order = rng.permutation(len(table))
    cells = [table[int(row)].as_void() for row in order]
    for row, cell in enumerate(cells):
        table[row] = tuple(cell)
    return f"rows in the order {order.tolist()}"


def _of_metadata(table: Table, name: str, rng: np.random.Generator) -> str:
    names = [*table.meta, "ra0_deg", "dec0_deg", "EQUINOX", "RADESYS", "reference_frequency"]
    key = str(names[rng.integers(len(names))])
    choice = rng.integers(3)
    if choice == 0:
        for known in [known for known in table.meta if known.lower() == key.lower()]:
            del table.meta[known]
        return f"metadata {key} removed"
    new = word(rng) if choice == 1 else wild_number(rng, 2000.0)
    table.meta[key] = new if isinstance(new, str) or np.isfinite(new) else str(new)
    return f"metadata {key} = {new!r}"


def _of_header(path: Path, rng: np.random.Generator) -> str:
    """Change a card of the header of a FITS table, so that it may contradict the data."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        header = fits.getheader(path, 1)
        cards = [name for name in header if name not in ("COMMENT", "HISTORY", "")]
        name = cards[rng.integers(len(cards))]
        data = path.read_bytes()
        place = data.find(f"{name:<8}=".encode(), 2880 if len(data) > 2880 else 0)
        if place < 0:
            return damage(rng, path)
        new = str(
            rng.choice(["7", "-1", "0", "'1J'", "'20A'", "'QB'", "T", "'x'", "1E5", "99999999"])
        )
        card = f"{name:<8}= {new:>20}".ljust(80).encode()
        path.write_bytes(data[:place] + card + data[place + 80 :])
    return f"the card {name} = {new}"


def _of_text(path: Path, rng: np.random.Generator) -> str:
    """Change lines, separators or the encoding of a text."""
    text = path.read_text()
    lines = text.splitlines()
    number = int(rng.integers(len(lines)))
    choice = rng.integers(9)
    if choice == 0:
        del lines[number]
        words = f"line {number + 1} removed"
    elif choice == 1:
        lines.insert(number, lines[int(rng.integers(len(lines)))])
        words = f"a line repeated as line {number + 1}"
    elif choice == 2:
        cells = lines[number].split(" ")
        cells[int(rng.integers(len(cells)))] = word(rng)
        lines[number] = " ".join(cells)
        words = f"a word of line {number + 1} changed: {lines[number][:60]!r}"
    elif choice == 3:
        lines[number] += f" {word(rng)}"
        words = f"a word more in line {number + 1}: {lines[number][-20:]!r}"
    elif choice == 4:
        old, new = map(str, rng.permutation([" ", ",", ";", "\t", "|", "."])[:2])
        lines = [line.replace(old, new) for line in lines]
        words = f"{new!r} for every {old!r}"
    elif choice == 5:
        lines[number] = lines[number][: int(rng.integers(len(lines[number]) + 1))]
        words = f"line {number + 1} cut: {lines[number][-20:]!r}"
    elif choice == 6:
        encoding = str(rng.choice(["utf-16", "utf-16-le", "utf-32", "latin-1", "utf-8-sig"]))
        path.write_bytes(text.replace("s1", "sö").encode(encoding))
        return f"encoded in {encoding}, with an umlaut"
    elif choice == 7:
        lines[number] = lines[number].replace(" ", "  ").replace(",", " , ")
        words = f"more blanks in line {number + 1}"
    else:
        other = int(rng.integers(len(lines)))
        lines[number], lines[other] = lines[other], lines[number]
        words = f"lines {number + 1} and {other + 1} exchanged"
    path.write_text("\n".join(lines) + "\n")
    return words
