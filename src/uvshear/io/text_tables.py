"""Tables in plain text: CSV and its relatives, columns between blanks, and what source finders write.

Columns are separated by semicolons, commas, tabs, bars or blanks. The names of the columns are the first line, or the
last line of ``#`` before the data that has as many words as the data have columns. ECSV and IPAC tables are recognised
by their own first lines.
"""

import csv
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
from astropy.table import Column, MaskedColumn, Table

from uvshear.errors import InputError

SEPARATORS = (";", ",", "\t", "|")
"""Separators in the order in which they are tried; blanks separate columns where none of these does."""

NO_VALUE = ("", "null", "NULL", "Null", "N/A", "NA", "None", "--")
"""Cells that have no value."""

_ENCODINGS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)


def read_text(content: bytes, texts: Collection[str] = ()) -> Table:
    """Read a table from the bytes of a text file.

    Parameters
    ----------
    content
        The file: UTF-8, or UTF-16 with a byte-order mark.
    texts
        Columns of identifiers, which stay text unless every cell is an integer as Python writes it ("007" is not).

    Raises
    ------
    InputError
        The text is no table; the message is the reason.
    """
    lines = _decoded(content).replace("\r\n", "\n").replace("\r", "\n").split("\n")
    first = next((line.strip() for line in lines if line.strip()), "")
    if first.startswith("# %ECSV"):
        table = Table.read(lines, format="ascii.ecsv")
        body = [line for line in lines if line.strip() and not line.startswith("#")]
        return _one_row_a_line(table, len(body) - 1)
    if first.startswith(("\\", "|")) and any(line.startswith("|") for line in lines[:1000]):
        return Table.read(lines, format="ascii.ipac")
    layout = Layout.from_lines(lines)
    if layout is None:
        # Other formats of astropy, such as those of CDS and of reStructuredText.
        return Table.read(lines, format="ascii")
    return layout.table(texts)


@dataclass(frozen=True)
class Layout:
    """Parts of a text table.

    Parameters
    ----------
    names
        Names of the columns.
    separator
        Separator of the columns.
    comments
        Lines of ``#`` before the data, without it.
    body
        Lines of the data.
    units
        Units of the columns, where a line below the names has them, as in tables of VizieR.
    """

    names: tuple[str, ...]
    separator: str
    comments: tuple[str, ...]
    body: list[str]
    units: tuple[str, ...] = ()

    @classmethod
    def from_lines(cls, lines: list[str]) -> "Layout | None":
        """Tell names, separator and data apart; None if the lines are no table with named columns."""
        body = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
        leading = (line.strip() for line in lines)
        comments = tuple(
            line.lstrip("#").strip() for line in _before_data(leading) if line.startswith("#")
        )
        if not body:
            # A list of no source, as of PyBDSF: a header alone.
            names = _split(comments[-1], _separator(comments[-1:])) if comments else []
            return cls(tuple(names), " ", comments[:-1], []) if len(names) > 1 else None
        separator = _separator(body[:2])
        columns = _split(body[0], separator)
        if not any(_is_number(cell) for cell in columns):
            for rule in (1, 2):
                if _is_rule(body[rule : rule + 1], separator):
                    units = _split(body[1], separator) if rule == 2 else []
                    return cls(_named(columns), separator, comments, body[rule + 1 :], tuple(units))
            return cls(_named(columns), separator, comments, body[1:])
        for place in reversed(range(len(comments))):
            names = _split(comments[place], separator)
            if len(names) != len(columns):
                names = comments[place].split()
            if len(names) == len(columns) and not any(_is_number(name) for name in names):
                others = comments[:place] + comments[place + 1 :]
                return cls(_named(names), separator, others, body)
        if not comments and separator == " ":
            return None
        raise InputError("no line has the names of its columns")

    def table(self, texts: Collection[str]) -> Table:
        """Return the data as a table, whose metadata have the comments."""
        if not self.body:
            return Table(names=self.names, meta={"comments": list(self.comments)})
        # A last empty cell of a line between blanks is not a cell.
        # The fast reader knows ASCII alone.
        is_ascii = all(line.isascii() for line in self.body)
        found = Table.read(
            [line.strip(" ") for line in self.body],
            format="ascii.fast_no_header" if is_ascii else "ascii.no_header",
            guess=False,
            delimiter=self.separator,
            names=self.names,
            fill_values=[(word, "0") for word in NO_VALUE],
        )
        _one_row_a_line(found, len(self.body))
        for name in set(texts) & set(self.names):
            found[name] = self._identifiers(self.names.index(name))
        for name, unit in zip(self.names, self.units, strict=False):
            found[name].unit = unit.strip('"') or None
        found.meta["comments"] = list(self.comments)
        return found

    def _identifiers(self, column: int) -> Column:
        cells = [row[column].strip() for row in _rows(self.body, self.separator)]
        if all(_is_plain_integer(cell) for cell in cells):
            return Column([int(cell) for cell in cells])
        return MaskedColumn(cells, mask=[cell == "" for cell in cells])


def _one_row_a_line(table: Table, lines: int) -> Table:
    """Refuse a table of which a quotation mark that is not closed has swallowed rows."""
    if len(table) != lines:
        raise InputError(
            f"its {lines} lines of data give {len(table)} rows; a quotation mark is not closed, or a cell goes over"
            " several lines"
        )
    return table


def _decoded(content: bytes) -> str:
    marked = (encoding for mark, encoding in _ENCODINGS if content.startswith(mark))
    encoding = next(marked, "utf-8")
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"line {line} has the byte 0x{content[error.start]:02x}, which is not UTF-8; save the file as UTF-8"
        ) from error


def _before_data(lines: Iterator[str]) -> Iterator[str]:
    for line in lines:
        if line and not line.startswith("#"):
            return
        yield line


def _rows(lines: Collection[str], separator: str) -> Iterator[list[str]]:
    # With blanks as separators, those that follow one another are one.
    return csv.reader(
        (line.strip() for line in lines) if separator == " " else lines,
        delimiter=separator,
        skipinitialspace=True,
    )


def _split(line: str, separator: str) -> list[str]:
    return [cell.strip() for cell in next(_rows([line], separator), [])]


def _separator(lines: Collection[str]) -> str:
    for separator in SEPARATORS:
        counts = {len(row) for row in islice(_rows(lines, separator), 2)}
        if len(counts) == 1 and max(counts) > 1:
            return separator
    return " "


def _is_rule(lines: list[str], separator: str) -> bool:
    """Tell whether a line consists of dashes alone, as between the head and the data of a table."""
    cells = [cell for line in lines for cell in _split(line, separator)]
    return bool(cells) and all(set(cell) == {"-"} for cell in cells)


def _named(names: list[str]) -> tuple[str, ...]:
    seen: set[str] = set()
    for place, name in enumerate(names, 1):
        if name == "":
            raise InputError(f"column {place} has no name")
        if name in seen:
            raise InputError(f"two columns are called '{name}'")
        seen.add(name)
    return tuple(names)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return cell.lower().strip("+-") not in {"nan", "inf", "infinity"}


def _is_plain_integer(cell: str) -> bool:
    return (
        cell.removeprefix("-").isdecimal()
        and cell.isascii()
        and str(int(cell)) == cell
        and abs(int(cell)) <= np.iinfo(np.int64).max
    )
