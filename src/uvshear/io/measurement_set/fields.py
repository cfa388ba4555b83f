"""Fields of a Measurement Set: which of them have rows, and their directions."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from casacore import tables

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre, separation
from uvshear.interferometer.dishes import SAME_POINTING
from uvshear.io.measurement_set.opening import casacore_errors, open_table

FRAMES: Final = ("J2000", "ICRS")
"""Frames of directions that are taken as they are; they agree to 0.03 arcsec."""

SAME_DIRECTION: Final = 1e-3 * ARCSEC
"""Distance between the phase centres of two rows of FIELD up to which they are taken to be one field [rad]."""


@dataclass(frozen=True)
class NamedField:
    """One field of the sky, which may have several rows in FIELD.

    Parameters
    ----------
    numbers
        Its FIELD_IDs, those with rows in the main table.
    name
        Its name, without blanks at the ends.
    phase_centre
        Direction of l = m = 0.
    """

    numbers: tuple[int, ...]
    name: str
    phase_centre: PhaseCentre

    def __str__(self) -> str:
        return f"{', '.join(map(str, self.numbers))} ({self.name})"


def choose_field(path: Path, present: Sequence[int], wanted: int | str | None) -> NamedField:
    """Return the field to read.

    Parameters
    ----------
    path
        Path of the set.
    present
        FIELD_IDs that have rows.
    wanted
        FIELD_ID or name; text that is not the name of a field, but a number, is a FIELD_ID. None is enough where there
        is only one field. All rows of FIELD that share the name and the phase centre of the one that is wanted are one
        field.
    """
    names = _names(path)
    known = [number for number in present if number in names]
    listed = ", ".join(f"{number} ({names[number]})" for number in known)
    if wanted is None:
        if not known:
            raise InputError(
                f"{path}: FIELD_ID {present[0]} has no row in FIELD, and so no phase centre"
            )
        if unknown := [number for number in present if number not in names]:
            raise InputError(
                f"{path}: FIELD_ID {unknown[0]} has no row in FIELD, and so no phase centre; the fields with phase"
                f" centres are {listed}: choose one with --field (field=)"
            )
        fields = _grouped(path, known, names)
        if len(fields) > 1:
            raise InputError(f"{path}: several fields, {listed}; choose one with --field (field=)")
        return fields[0]
    numbers = _meant(wanted, present, names)
    if not numbers:
        raise InputError(f"{path}: no rows of field {wanted}; the fields with rows are {listed}")
    if numbers[0] not in names:
        raise InputError(
            f"{path}: FIELD_ID {numbers[0]} has no row in FIELD, and so no phase centre"
        )
    fields = _grouped(path, numbers, names)
    if len(fields) > 1:
        raise InputError(
            f"{path}: field {wanted} is the name of several fields with different phase centres, FIELD_IDs"
            f" {', '.join(map(str, numbers))}; choose one by its number with --field (field=)"
        )
    return fields[0]


def fields_with_rows(path: Path, present: Sequence[int]) -> tuple[NamedField, ...]:
    """Return all fields that can be chosen, in the order of their first FIELD_ID."""
    names = _names(path)
    if unknown := [number for number in present if number not in names]:
        raise InputError(
            f"{path}: FIELD_ID {unknown[0]} has no row in FIELD, and so no phase centre"
        )
    return _grouped(path, present, names)


def _names(path: Path) -> Mapping[int, str]:
    """Name of each row of FIELD; its number stands for the name in a set without names."""
    with open_table(path, "FIELD") as fields, casacore_errors(path, "FIELD"):
        rows = fields.nrows()
        has_names = "NAME" in fields.colnames()
        names = fields.getcol("NAME") if has_names and rows else [""] * rows
    if not rows:
        raise InputError(
            f"{path}: FIELD is empty, so there is no phase centre; it needs a row (if files called table.lock were"
            " removed from the set, put them back: they may hold the numbers of rows)"
        )
    return {number: str(name).strip() for number, name in enumerate(names)}


def _meant(wanted: int | str, present: Sequence[int], names: Mapping[int, str]) -> list[int]:
    """Return the FIELD_IDs that a number or a name stands for."""
    if isinstance(wanted, int) and wanted in present:
        return [wanted]
    word = str(wanted).strip()
    named = [number for number in present if names.get(number) == word]
    if not named and word.isdecimal() and int(word) in present:
        return [int(word)]
    return named


def _grouped(
    path: Path, numbers: Sequence[int], names: Mapping[int, str]
) -> tuple[NamedField, ...]:
    """Join the rows of FIELD that share name and phase centre."""
    groups: list[tuple[list[int], str, PhaseCentre]] = []
    for number in numbers:
        centre = read_direction(path, number)
        for members, name, place in groups:
            if name == names[number] and separation(place, centre) < SAME_DIRECTION:
                members.append(number)
                break
        else:
            groups.append(([number], names[number], centre))
    return tuple(NamedField(tuple(members), name, centre) for members, name, centre in groups)


def read_direction(path: Path, field: int, column: str = "PHASE_DIR") -> PhaseCentre:
    """Read a direction of a field that does not move."""
    with open_table(path, "FIELD") as fields, casacore_errors(path, f"{column} of FIELD"):
        if column not in fields.colnames() or not fields.iscelldefined(column, field):
            raise InputError(f"{path}: FIELD has no {column} for field {field}; it needs one")
        frame = _frame(path, fields, column, field)
        ephemeris = _ephemeris(path, fields, field)
        direction = np.ravel(fields.getcell(column, field))
    if frame not in FRAMES:
        raise InputError(
            f"{path}: {column} of field {field} is in frame {frame}; {' or '.join(FRAMES)} is needed"
        )
    if ephemeris >= 0:
        raise InputError(
            f"{path}: field {field} moves (it follows EPHEMERIS_ID {ephemeris}); a fixed direction is needed"
        )
    if len(direction) < 2 or direction.dtype.kind not in "fiu":
        raise InputError(
            f"{path}: {column} of field {field} has {direction.size} numbers; right ascension and declination are"
            " needed"
        )
    if np.any(direction[2:] != 0):
        raise InputError(
            f"{path}: field {field} moves ({column} is a polynomial in time); a fixed direction is needed"
        )
    # A polynomial of degree 0 is stored as (1, 2), one of a higher degree as (degree + 1, 2).
    ra, dec = (float(angle) for angle in direction[:2])
    if not (math.isfinite(ra) and abs(dec) <= math.pi / 2):
        raise InputError(f"{path}: {column} of field {field} is ({ra}, {dec}); radians are needed")
    return PhaseCentre(ra=ra, dec=dec)


def _frame(path: Path, fields: tables.table, column: str, field: int) -> str:
    """Return the frame of a direction, which is given once for the column or separately for each row."""
    reference = fields.getcolkeywords(column).get("MEASINFO", {})
    if not isinstance(reference, dict):
        raise InputError(
            f"{path}: the keyword MEASINFO of {column} in FIELD is {reference!r}; a record with the frame of its"
            " directions is needed"
        )
    if (by_row := reference.get("VarRefCol")) is None:
        return str(reference.get("Ref", "J2000"))
    if by_row not in fields.colnames():
        raise InputError(
            f"{path}: the frame of {column} in FIELD is said to be in the column {by_row}, which is not there"
        )
    value = fields.getcell(by_row, field)
    if isinstance(value, str):
        return value.strip()
    codes = np.ravel(reference.get("TabRefCodes", [])).tolist()
    words = list(np.ravel(reference.get("TabRefTypes", [])))
    known = dict(zip(codes, words, strict=False))
    return str(known.get(value, f"number {value}")) if np.ndim(value) == 0 else "not known"


def _ephemeris(path: Path, fields: tables.table, field: int) -> int:
    """Return the number of the ephemeris that the field follows; -1 if it follows none."""
    if "EPHEMERIS_ID" not in fields.colnames() or not fields.iscelldefined("EPHEMERIS_ID", field):
        return -1
    value = fields.getcell("EPHEMERIS_ID", field)
    if not isinstance(value, int):
        raise InputError(
            f"{path}: EPHEMERIS_ID of field {field} is {value!r}; a whole number is needed"
        )
    return value


def read_pointing(path: Path, field: int) -> PhaseCentre:
    """Read the pointing direction of the dishes in a field.

    That is REFERENCE_DIR of FIELD, or DELAY_DIR in a set without: a change of the phase centre after the observation
    changes PHASE_DIR only. In a set with neither, the phase centre is taken to be that of the observation.
    """
    with open_table(path, "FIELD") as fields:
        present = [
            name
            for name in ("REFERENCE_DIR", "DELAY_DIR")
            if name in fields.colnames() and fields.iscelldefined(name, field)
        ]
    axes = [read_direction(path, field, name) for name in present or ("PHASE_DIR",)]
    apart = max(separation(axes[0], axis) for axis in axes)
    if apart > SAME_POINTING:
        raise InputError(
            f"{path}: REFERENCE_DIR and DELAY_DIR of FIELD are {apart / ARCSEC:.3g} arcsec apart, so it is not known"
            " where the dishes pointed; make the two agree, or measure without a primary beam (--primary-beam none,"
            " primary_beam=None)"
        )
    return axes[0]
