"""Columns of a user's table, in SI, with errors that name the column and the row."""

from typing import Any

import numpy as np
from astropy import units
from astropy.coordinates import Angle
from astropy.table import Column, MaskedColumn, Table

from uvshear.errors import InputError
from uvshear.typing import Array, Bool, Float, Shaped


class Columns:
    """Columns of a table, found by name in upper or lower case."""

    def __init__(self, table: Table, name: str) -> None:
        self.table = Table(table, copy=False)  # a QTable's quantities become columns
        self.name = name
        self.names: tuple[str, ...] = tuple(table.colnames)
        self._spelling = {known.lower(): known for known in reversed(self.names)}
        self._spelling |= {known: known for known in self.names}
        self.identifier = self._identifiers()

    @property
    def metadata(self) -> dict[str, Any]:
        """Metadata of the table by lower-case key; FITS has them in capitals."""
        return {str(key).lower(): value for key, value in self.table.meta.items()}

    def has(self, column: str) -> bool:
        """Tell whether the table has the column, in upper or lower case."""
        return column in self._spelling

    def words(self, column: str) -> Shaped[Array, " source"]:
        """Text in lower case, without blanks around it; empty where the table has no value."""
        values: Array = np.ma.filled(
            np.ma.asarray(self.table[self._spelling[column]], dtype=str), ""
        )
        return np.array([word.strip().lower() for word in values.tolist()])

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
                f"{self.name}: has no column '{column}' (it has {', '.join(self.names)})"
            )
        values = self.table[self._spelling[column]]
        if values.dtype.kind in "US" and unit == units.rad:
            values = _angles(values, column)
        try:
            plain: Array = np.ma.filled(np.ma.asarray(values, dtype=float), np.nan)
        except (TypeError, ValueError) as error:
            raise InputError(
                f"{self.name}: column '{column}' holds text; numbers are needed"
            ) from error
        if plain.ndim != 1:
            raise InputError(
                f"{self.name}: column '{column}' holds arrays; one number for each row is needed"
            )
        plain = plain * self._factor(column, values, unit, given, assumed, needs_unit)
        self.require(column, np.isfinite(plain), "a finite number is needed", plain)
        return plain

    def error(
        self, column: str, unit: units.UnitBase, *, assumed: units.UnitBase
    ) -> Float[Array, " source"]:
        """Errors in ``unit``; 0 where a source finder gives none, or gives -1, which means none."""
        values = self.table[self._spelling[column]]
        try:
            plain: Array = np.ma.filled(np.ma.asarray(values, dtype=float), 0.0)
        except (TypeError, ValueError) as error:
            raise InputError(
                f"{self.name}: column '{column}' holds text; numbers are needed"
            ) from error
        factor = self._factor(column, values, unit, None, assumed, needs_unit=False)
        return np.where(np.isfinite(plain) & (plain > 0), plain, 0.0) * factor

    def unit_of(self, column: str, given: str | None) -> units.UnitBase:
        """Return the unit of a column that has been read: its own, or the one that was given for it."""
        found = self.table[self._spelling[column]].unit
        return units.Unit(given if found is None or str(found).strip() == "" else found)

    def _factor(
        self,
        column: str,
        values: Column | units.Quantity,
        unit: units.UnitBase,
        given: str | None,
        assumed: units.UnitBase | None,
        needs_unit: bool = False,
    ) -> float:
        found = values.unit
        if found is None or str(found).strip() == "":
            if given is not None:
                try:
                    found = units.Unit(given)
                except ValueError as error:
                    raise InputError(
                        f"--flux-unit {given} (flux_unit=): is not a unit; column '{column}' needs one such as Jy,"
                        " mJy or uJy"
                    ) from error
            elif needs_unit:
                raise InputError(
                    f"{self.name}: column '{column}' has no unit; give it one in the file"
                    " (Jy, mJy, uJy), or --flux-unit (flux_unit=) for a format without units"
                )
            else:
                return float((assumed or unit).to(unit))
        try:
            return float(units.Unit(found).to(unit))
        except (units.UnitConversionError, ValueError, TypeError) as error:
            needed = (
                "but it must be dimensionless"
                if unit == units.dimensionless_unscaled
                else f"which cannot be converted to {unit}"
            )
            raise InputError(f"{self.name}: column '{column}' is in '{found}', {needed}") from error

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
                f"{self.name}: column '{column}' is {values[row]:.4g} for id {self.identifier[row]}; {needed}"
            )

    def _identifiers(self) -> Shaped[Array, " source"]:
        if not self.has("id"):
            return np.arange(1, len(self.table) + 1)
        column = self.table[self._spelling["id"]]
        if isinstance(column, MaskedColumn) and np.any(column.mask):
            raise InputError(
                f"{self.name}: column 'id', row {int(np.argmax(column.mask)) + 1}: is empty;"
                " every source needs its own id, or the column must be left out"
            )
        identifier = np.asarray(column)
        if identifier.dtype.kind not in "iu":
            identifier = identifier.astype(str)
        values, count = np.unique(identifier, return_counts=True)
        if np.any(count > 1):
            raise InputError(
                f"{self.name}: column 'id': {values[np.argmax(count > 1)]} occurs"
                f" {count[np.argmax(count > 1)]} times; every source needs its own id"
            )
        return identifier


def _angles(texts: Column, column: str) -> Column:
    """Read angles such as 03h28m12.6s and -27:35:15; right ascensions without letters are in hours."""
    if not any(mark in str(texts[0]) for mark in ":hmd "):
        return texts
    unit = units.hourangle if column == "ra" else units.deg
    try:
        degrees = Angle([str(text) for text in texts], unit=unit).to_value(units.deg)
    except (ValueError, TypeError, units.UnitsError):
        # The caller, who needs numbers, reports what is wrong.
        return texts
    return Column(degrees, unit=units.deg)
