"""JSON files that commands write and other commands read."""

import json
import math
from collections.abc import Mapping
from pathlib import Path

from uvshear.errors import InputError


def read_record(path: Path, what: str) -> dict[str, object]:
    """Read names and values; ``what`` describes the expected file in messages."""
    if not path.exists():
        raise InputError(f"{path}: no such file; {what} is needed")
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as JSON: {error}") from error
    if not isinstance(record, dict):
        raise InputError(f"{path}: is not {what}")
    return record


def finite(record: Mapping[str, object], name: str) -> float | None:
    """Return the number of this name in the record, or None if there is no finite one."""
    value = record.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value) if math.isfinite(value) else None
    except OverflowError:
        return None


def rounded(value: float) -> float:
    """Return a number in the unit of a file without the rounding errors of the conversion of units."""
    return float(f"{value:.12g}")
