"""Columns of a user's table, in SI, with errors that name the column and the row."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from astropy import units
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.io.angles import degrees_of, is_sexagesimal
from uvshear.io.cells import cells_of
from uvshear.typing import Array, Bool, Float, Shaped

_SPELLINGS: Final = {
    "degrees": units.deg,
    "degree": units.deg,
    "deg": units.deg,
    "rad": units.rad,
    "radians": units.rad,
    "arcsec": units.arcsec,
    "arcseconds": units.arcsec,
    "jy": units.Jy,
    "jansky": units.Jy,
    "hz": units.Hz,
}
"""Units that files spell in their own ways, in lower case. With a prefix the case matters: MJY is not mJy."""

_LARGEST_WHOLE: Final = 2.0**53
"""Numbers below this are exact as floats, and fit into the integers of every format of tables."""


@dataclass(frozen=True)
class NamedColumn:
    """Column of a table from which a quantity of this package is read.

    Parameters
    ----------
    column
        Name of the column.
    assumed
        Unit where the table gives none, as known from the program that wrote it.
    """

    column: str
    assumed: units.UnitBase | None = None


class Columns:
    """Columns of a table, found by name in upper or lower case.

    Parameters
    ----------
    table
        The table.
    name
        Name of the table in messages.
    sources
        Columns that have other names in the table, by the names of this package.
    facts
        Metadata that the table states in a form of its own, by lower-case key.
    """

    def __init__(
        self,
        table: Table,
        name: str,
        sources: Mapping[str, NamedColumn] | None = None,
        facts: Mapping[str, Any] | None = None,
    ) -> None:
        self.table = Table(table, copy=False)  # a QTable's quantities become columns
        self.name = name
        self.names: tuple[str, ...] = tuple(table.colnames)
        self._sources = {known.lower(): NamedColumn(known) for known in reversed(self.names)}
        self._sources |= {known: NamedColumn(known) for known in self.names}
        self._sources |= sources or {}
        self._facts = facts or {}
        self.has_identifiers = self.has("id")
        self.identifier = self._identifiers()

    @property
    def metadata(self) -> dict[str, Any]:
        """Metadata of the table by lower-case key; FITS has them in capitals."""
        own = {str(key).lower(): value for key, value in self.table.meta.items()}
        return {**self._facts, **own}

    def has(self, column: str) -> bool:
        """Tell whether the table has the column, in upper or lower case."""
        return column in self._sources

    def source(self, column: str) -> str:
        """Name of a column in the table."""
        return self._sources[column].column

    def metadata_of(self, column: str) -> Mapping[str, Any]:
        """Metadata of a column."""
        return self.table[self._sources[column].column].info.meta or {}

    def has_unit(self, column: str) -> bool:
        """Tell whether the table, or the program that wrote it, gives a column a unit."""
        return self._stated_unit(column) is not None or self._sources[column].assumed is not None

    def words(self, column: str) -> Shaped[Array, " source"]:
        """Text in lower case, without blanks around it; empty where the table has no value."""
        cells = self._cells(column)
        if cells.dtype.kind != "U":
            raise InputError(f"{self._named(column)} holds numbers; words are needed")
        return np.char.lower(cells.filled(""))

    def number(
        self,
        column: str,
        unit: units.UnitBase,
        *,
        given: str | None = None,
        assumed: units.UnitBase | None = None,
        needs_unit: bool = False,
    ) -> Float[Array, " source"]:
        """Finite numbers in ``unit``; a column without a unit gets the ``given`` one, or else the ``assumed`` one."""
        if not self.has(column):
            raise InputError(
                f"{self.name}: has no column '{column}' (it has {', '.join(self.names)});"
                f" --column-map {column}=NAME (column_map=) names the one to use"
            )
        plain, mask = self._numbers(column, unit, given, assumed, needs_unit=needs_unit)
        if mask.any():
            raise InputError(
                f"{self._named(column)} has no value for {self._row(int(np.argmax(mask)))};"
                " a finite number is needed"
            )
        self.require(column, np.isfinite(plain), "a finite number is needed", plain)
        return plain

    def known(
        self, column: str, unit: units.UnitBase, *, assumed: units.UnitBase
    ) -> Float[Array, " source"]:
        """Numbers in ``unit``, NaN where the table has none."""
        plain, mask = self._numbers(column, unit, None, assumed)
        return np.where(mask | ~np.isfinite(plain), np.nan, plain)

    def error(
        self, column: str, unit: units.UnitBase, *, assumed: units.UnitBase
    ) -> Float[Array, " source"]:
        """Errors in ``unit``; 0 where a source finder gives none, or gives -1, which means none."""
        plain = self.known(column, unit, assumed=assumed)
        return np.where(plain > 0, plain, 0.0)

    def unit_of(self, column: str, given: str | None) -> units.UnitBase:
        """Return the unit of a column that has been read: its own, or the one that was given for it."""
        return self._unit(column, given, self._sources[column].assumed)

    def require(
        self,
        column: str,
        good: Bool[Array, " source"],
        needed: str,
        values: Shaped[Array, " source"],
    ) -> None:
        """Raise an error that names the first row that is not valid."""
        if not np.all(good):
            row = int(np.argmin(good))
            raise InputError(
                f"{self._named(column)} is {values[row]:.4g} for {self._row(row)}; {needed}"
            )

    def _named(self, column: str) -> str:
        name = self._sources[column].column if column in self._sources else column
        return f"{self.name}: column '{name}'"

    def _row(self, row: int) -> str:
        """Name a row by the identifier of its source, or by its number, from 1."""
        return f"id {shown(self.identifier[row])}" if self.has_identifiers else f"row {row + 1}"

    def _cells(self, column: str) -> np.ma.MaskedArray:
        try:
            return cells_of(self.table[self._sources[column].column])
        except InputError as error:
            raise InputError(f"{self._named(column)} {error}") from error

    def _numbers(
        self,
        column: str,
        unit: units.UnitBase,
        given: str | None,
        assumed: units.UnitBase | None,
        *,
        needs_unit: bool = False,
    ) -> tuple[Float[Array, " source"], Bool[Array, " source"]]:
        """Numbers in ``unit``, and whether they are missing."""
        cells = self._cells(column)
        mask = np.ma.getmaskarray(cells)
        if cells.dtype.kind != "U":
            plain = np.where(mask, np.nan, cells.data).astype(float)
        elif unit == units.rad and any(map(is_sexagesimal, cells.compressed()[:100].tolist())):
            return np.radians(self._angles(column, cells)), mask
        else:
            plain, is_number = _numbers_of(cells.data.tolist())
            self._require_no_text(column, mask | is_number, cells, "a number")
        return plain * self._factor(column, unit, given, assumed, needs_unit), mask

    def _angles(self, column: str, cells: np.ma.MaskedArray) -> Float[Array, " source"]:
        """Angles that are written out [deg]; right ascensions without letters are in hours unless in degrees."""
        stated = self._stated_unit(column) or ""
        in_hours = "h" in stated if stated else column == "ra"
        degrees = degrees_of(cells.data.tolist(), in_hours=in_hours)
        mask = np.ma.getmaskarray(cells)
        self._require_no_text(column, mask | np.isfinite(degrees), cells, "an angle")
        return degrees

    def _require_no_text(
        self, column: str, good: Bool[Array, " source"], cells: np.ma.MaskedArray, needed: str
    ) -> None:
        if not good.all():
            row = int(np.argmin(good))
            raise InputError(
                f"{self._named(column)} holds text ('{shown(cells.data[row])}' for {self._row(row)});"
                f" {needed} is needed"
            )

    def _stated_unit(self, column: str) -> str | None:
        found = self.table[self._sources[column].column].unit
        text = "" if found is None else str(found).strip()
        return text or None

    def _unit(
        self, column: str, given: str | None, assumed: units.UnitBase | None
    ) -> units.UnitBase | None:
        if (stated := self._stated_unit(column)) is not None:
            return self._parsed(column, stated)
        if given is None:
            return assumed
        try:
            return _unit_of(given)
        except (ValueError, TypeError) as error:
            raise InputError(
                f"--flux-unit {given} (flux_unit=): is not a unit; column '{self.source(column)}' needs one such as"
                " Jy, mJy or uJy"
            ) from error

    def _parsed(self, column: str, stated: str) -> units.UnitBase:
        try:
            return _unit_of(stated)
        except (ValueError, TypeError) as error:
            raise InputError(
                f"{self._named(column)} is in '{stated}', which is no unit that is known"
            ) from error

    def _factor(
        self,
        column: str,
        unit: units.UnitBase,
        given: str | None,
        assumed: units.UnitBase | None,
        needs_unit: bool = False,
    ) -> float:
        convention = self._sources[column].assumed
        found = self._unit(column, given, convention)
        if found is None:
            if needs_unit:
                raise InputError(
                    f"{self._named(column)} has no unit; give it one in the file"
                    " (Jy, mJy, uJy), or --flux-unit (flux_unit=) for a format without units"
                )
            return float((assumed or unit).to(unit))
        try:
            return float(found.to(unit))
        except units.UnitConversionError as error:
            needed = (
                "but it must be dimensionless"
                if unit == units.dimensionless_unscaled
                else f"which cannot be converted to {unit}"
            )
            raise InputError(f"{self._named(column)} is in '{found}', {needed}") from error

    def _identifiers(self) -> Shaped[Array, " source"]:
        if not self.has_identifiers:
            return np.arange(1, len(self.table) + 1)
        cells = self._cells("id")
        mask = np.ma.getmaskarray(cells)
        if cells.dtype.kind == "f":
            mask = mask | ~np.isfinite(cells.data)
        if mask.any():
            raise InputError(
                f"{self._named('id')}, row {int(np.argmax(mask)) + 1}: is empty;"
                " every source needs its own id, or the column must be left out"
            )
        identifier: Array = cells.data
        if identifier.dtype.kind in "iuf":
            whole = np.all((np.abs(identifier) < _LARGEST_WHOLE) & (identifier % 1 == 0))
            identifier = identifier.astype(
                np.int64 if whole or identifier.dtype.kind == "i" else str
            )
        values, count = np.unique(identifier, return_counts=True)
        if np.any(count > 1):
            raise InputError(
                f"{self._named('id')}: {shown(values[np.argmax(count > 1)])} occurs"
                f" {count[np.argmax(count > 1)]} times; every source needs its own id"
            )
        return identifier


def shown(cell: object) -> str:
    """Return a cell as a message may show it, in one line and not longer than 60 characters."""
    text = str(cell)
    return (text if text.isprintable() else ascii(text)[1:-1])[:60]


def _unit_of(text: str) -> units.UnitBase:
    """Return the unit of a text; magnitudes and decibels, which are no multiples of a unit, are a ValueError."""
    found = _SPELLINGS.get(text.lower()) or units.Unit(text)
    if not isinstance(found, units.UnitBase):
        raise ValueError(text)
    return found


def _numbers_of(texts: list[str]) -> tuple[Float[Array, " source"], Bool[Array, " source"]]:
    """Read numbers from texts, and tell which texts are numbers; NaN is one."""
    plain, is_number = np.full(len(texts), np.nan), np.ones(len(texts), bool)
    for row, text in enumerate(texts):
        try:
            plain[row] = float(text)
        except ValueError:
            is_number[row] = False
    return plain, is_number
