"""Variables of an MSv4 group, with checks of their content, and the quantities and units in attributes."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from uvshear.errors import InputError
from uvshear.io.msv4.opening import Dataset, zarr_errors
from uvshear.typing import Array, Float


def numbers(
    place: Path, group: Dataset, name: str, dimensions: Sequence[str]
) -> Float[Array, "..."]:
    """Return a variable of real numbers with exactly these dimensions, in this order.

    Raises
    ------
    InputError
        There is no such variable, or it holds something else.
    """
    if name not in group.variables:
        raise InputError(f"{place}: has no variable {name}; it is needed")
    found = group[name]
    check_dimensions(place, name, found.dims, dimensions)
    if found.dtype.kind not in "fiu":
        raise InputError(f"{place}: {name} does not hold numbers but {found.dtype}")
    with zarr_errors(place, name):
        return np.asarray(found.transpose(*dimensions).values, float)


def check_dimensions(
    place: Path, name: str, found: Sequence[str], needed: Sequence[str], *, all_of: bool = True
) -> None:
    """Refuse a variable that does not have these dimensions: all of them, or only some of them without ``all_of``."""
    if not (set(found) == set(needed) if all_of else set(found) <= set(needed)):
        raise InputError(
            f"{place}: {name} has the dimensions ({', '.join(map(str, found))}); ({', '.join(needed)})"
            f" {'are needed' if all_of else 'are possible'}"
        )


def texts(place: Path, group: Dataset, name: str) -> tuple[str, ...]:
    """Return a coordinate of text without blanks at the ends, whatever type the store gives it."""
    if name not in group.variables:
        raise InputError(f"{place}: has no variable {name}; it is needed")
    with zarr_errors(place, name):
        return tuple(str(value).strip() for value in np.ravel(group[name].values).tolist())


def quantity(holder: Mapping[str, Any], name: str) -> Float[Array, " value"] | None:
    """Return the numbers in an attribute, which may be a dictionary with the entry ``data``; None if there are none."""
    found = holder.get(name)
    value = found.get("data") if isinstance(found, dict) else found
    try:
        values = np.ravel(np.asarray(value, float))
    except (TypeError, ValueError):
        return None
    return values if len(values) and np.isfinite(values).all() else None


def unit_of(attributes: Mapping[str, Any]) -> str:
    """Return the attribute ``units``, which older versions of the schema give as a list; empty where there is none."""
    units = attributes.get("units", "")
    return str(units[0] if isinstance(units, list) and units else units)
