"""JSON files that commands write and read again."""

import json
import math
from collections.abc import Mapping
from pathlib import Path

from uvshear.errors import InputError


def read_record(path: Path, what: str) -> dict[str, object]:
    """Read names and values; the error of a file that has none says ``what`` it was to be."""
    if not path.exists():
        raise InputError(f"{path}: no such file")
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as JSON: {error}") from error
    if not isinstance(record, dict):
        raise InputError(f"{path}: is not {what}")
    return record


def finite(record: Mapping[str, object], name: str) -> float | None:
    """Return a finite number of the record, or None where it has none."""
    value = record.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value) if math.isfinite(value) else None
    except OverflowError:
        return None
