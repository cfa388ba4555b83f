"""Fields of an MSv4 store: which of them have visibilities, and their directions."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre, separation
from uvshear.io.msv4.opening import Dataset, open_group, zarr_errors
from uvshear.io.msv4.variables import check_dimensions, texts, unit_of

FRAMES: Final = ("fk5", "icrs")
"""Frames of directions that are taken as they are; they agree to 0.03 arcsec. xradio calls J2000 fk5."""

SAME_DIRECTION: Final = 1e-3 * ARCSEC
"""Distance between the phase centres of two fields of one name up to which they are taken to be one field [rad]."""

PHASE_CENTRE: Final = "FIELD_PHASE_CENTER_DIRECTION"
"""Direction of l = m = 0."""

REFERENCE: Final = "FIELD_REFERENCE_CENTER_DIRECTION"
"""Direction in which the dishes pointed, in stores that have it."""


@dataclass(frozen=True)
class FieldLabel:
    """Name of a field in a store.

    Parameters
    ----------
    label
        The name as the store has it.
    name
        The name of the field, without the FIELD_ID of the Measurement Set, which xradio appends.
    number
        The FIELD_ID; None where it is not known.
    """

    label: str
    name: str
    number: int | None

    @classmethod
    def from_label(cls, label: str, attributes: Mapping[str, Any]) -> "FieldLabel":
        """Split the name of a field in a partition with these attributes into name and FIELD_ID."""
        creator = attributes.get("creator")
        software = creator.get("software_name") if isinstance(creator, dict) else None
        split = re.fullmatch(r"(.*)_(\d{1,9})", label, re.DOTALL) if software == "xradio" else None
        if split is None:
            return cls(label, label, None)
        return cls(label, split[1].strip(), int(split[2]))

    def __str__(self) -> str:
        return self.label if self.number is None else f"{self.number} ({self.name})"


@dataclass(frozen=True)
class StoreField:
    """One field of the sky, which may have several names in the store.

    Parameters
    ----------
    labels
        Its names in the store.
    phase_centre
        Direction of l = m = 0.
    """

    labels: tuple[FieldLabel, ...]
    phase_centre: PhaseCentre

    @property
    def name(self) -> str:
        """Name of the field."""
        return self.labels[0].name

    @property
    def number(self) -> int | None:
        """FIELD_ID of the first of its names; None where it is not known."""
        return self.labels[0].number

    @property
    def names_in_store(self) -> tuple[str, ...]:
        """Names of the field in the store."""
        return tuple(label.label for label in self.labels)


FieldPlaces = Mapping[FieldLabel, Sequence[Path]]
"""For each field name that has visibilities, the subgroups that describe it."""


def choose_field(path: Path, present: FieldPlaces, wanted: int | str | None) -> StoreField:
    """Return the field to read.

    Parameters
    ----------
    path
        Path of the store.
    present
        Names that have visibilities.
    wanted
        A name, with or without the FIELD_ID that xradio adds to it, or this number. None is enough where there is only
        one field. All names that differ only in their number and share the phase centre of the one that is wanted are
        one field.
    """
    listed = ", ".join(map(str, present))
    if wanted is None:
        fields = grouped(path, present)
        if len(fields) > 1:
            raise InputError(f"{path}: several fields, {listed}; choose one with --field (field=)")
        return fields[0]
    chosen = _meant(wanted, list(present))
    if not chosen:
        raise InputError(f"{path}: no rows of field {wanted}; the fields with rows are {listed}")
    fields = grouped(path, {label: present[label] for label in chosen})
    if len(fields) > 1:
        raise InputError(
            f"{path}: field {wanted} is the name of several fields with different phase centres,"
            f" {', '.join(label.label for label in chosen)}; choose one of these with --field (field=)"
        )
    return fields[0]


def grouped(path: Path, present: FieldPlaces) -> tuple[StoreField, ...]:
    """Return all fields that can be chosen; names that differ only in their number can be one field."""
    groups: list[StoreField] = []
    for label, places in present.items():
        centre = _phase_centre(path, label, places)
        for index, group in enumerate(groups):
            if group.name == label.name and separation(group.phase_centre, centre) < SAME_DIRECTION:
                groups[index] = StoreField((*group.labels, label), group.phase_centre)
                break
        else:
            groups.append(StoreField((label,), centre))
    return tuple(groups)


def read_field_names(group: Path) -> tuple[str, ...]:
    """Return the names in a subgroup of fields; empty if there is no such subgroup."""
    if not group.is_dir():
        return ()
    with open_group(group) as fields:
        return texts(group, fields, "field_name") if "field_name" in fields.variables else ()


def read_direction(group: Path, label: FieldLabel, *, wants_pointing: bool = False) -> PhaseCentre:
    """Read the phase centre of a field that does not move, or the direction in which the dishes pointed.

    The pointing is the phase centre where the store does not have it.
    """
    if not group.is_dir():
        raise InputError(f"{group}: there is no such group, and so no phase centre; it is needed")
    with open_group(group) as fields:
        name = REFERENCE if wants_pointing and REFERENCE in fields.variables else PHASE_CENTRE
        if "ephemeris" in str(fields.attrs.get("type", "")):
            raise InputError(
                f"{group}: field {label.label} moves (it follows an ephemeris); a fixed direction is needed"
            )
        if name not in fields.variables:
            raise InputError(f"{group}: has no {name} for field {label.label}; it needs one")
        return _direction(group, fields, name, label)


def _direction(group: Path, fields: Dataset, name: str, label: FieldLabel) -> PhaseCentre:
    found = fields[name]
    check_dimensions(group, name, found.dims, ("field_name", "sky_dir_label"), all_of=False)
    if "field_name" in found.dims:
        names = texts(group, fields, "field_name") if "field_name" in fields.variables else ()
        if label.label not in names:
            raise InputError(
                f"{group}: has no field {label.label}, and so no phase centre for it; its fields are"
                f" {', '.join(names) or 'without names'}"
            )
        found = found.isel(field_name=names.index(label.label))
    frame, unit = str(found.attrs.get("frame", "icrs")), unit_of(found.attrs) or "rad"
    if frame.lower() not in FRAMES:
        raise InputError(
            f"{group}: {name} of field {label.label} is in frame {frame}; {' or '.join(FRAMES)} is needed"
        )
    if unit != "rad":
        raise InputError(f"{group}: {name} is in {unit}; rad is needed")
    with zarr_errors(group, name):
        direction = np.ravel(found.values)
    if direction.size != 2 or direction.dtype.kind not in "fiu":
        raise InputError(
            f"{group}: {name} of field {label.label} has {direction.size} numbers; right ascension and declination"
            " are needed"
        )
    ra, dec = (float(angle) for angle in direction)
    if not (math.isfinite(ra) and abs(dec) <= math.pi / 2):
        raise InputError(
            f"{group}: {name} of field {label.label} is ({ra}, {dec}); radians are needed"
        )
    return PhaseCentre(ra=ra, dec=dec)


def _phase_centre(path: Path, label: FieldLabel, places: Sequence[Path]) -> PhaseCentre:
    """Read a phase centre that several groups may give."""
    centres = [read_direction(place, label) for place in places]
    for place, centre in zip(places[1:], centres[1:], strict=True):
        if separation(centre, centres[0]) > SAME_DIRECTION:
            raise InputError(
                f"{path}: field {label.label} has one phase centre in {places[0].relative_to(path)} and another in"
                f" {place.relative_to(path)}; one field must have one phase centre"
            )
    return centres[0]


def _meant(wanted: int | str, present: Sequence[FieldLabel]) -> list[FieldLabel]:
    """Return the names that a number or a name stands for."""
    word = str(wanted).strip()
    if not isinstance(wanted, int):
        for matches in (
            [label for label in present if label.label == word],
            [label for label in present if label.name == word],
        ):
            if matches:
                return matches
    if word.isdecimal():
        numbered = [label for label in present if label.number == int(word)]
        return numbered or [label for label in present if label.label == word]
    return []
