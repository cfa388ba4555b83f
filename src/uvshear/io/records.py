"""JSON files that commands write and other commands read."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from uvshear.errors import InputError

LONGEST: Final = 10_000_000
"""Size of the largest file that is read [bytes]; those that commands write have a few kilobytes."""


def read_record(path: Path, what: str) -> dict[str, object]:
    """Read names and values; ``what`` describes the expected file in messages."""
    if not path.exists():
        raise InputError(f"{path}: no such file; {what} is needed")
    try:
        if path.is_file() and path.stat().st_size > LONGEST:
            raise InputError(f"{path}: is too large; {what} is needed")
        # Editors may write a mark of the byte order, which JSON does not have.
        record = json.loads(path.read_text(encoding="utf-8-sig"), object_pairs_hook=_unambiguous)
    except RecursionError:
        raise InputError(f"{path}: cannot be read as JSON: it is nested too deeply") from None
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as JSON: {error}") from error
    if not isinstance(record, dict):
        raise InputError(f"{path}: is not {what}")
    return record


def _unambiguous(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    """Return names and values; of a name that is given twice, JSON does not say which value holds."""
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"'{twice}' is given more than once")
    return found


@dataclass(frozen=True)
class CheckedRecord:
    """Names and values of a file, each of which is checked when it is asked for.

    Parameters
    ----------
    name
        Name of the file, or of a part of it, in messages.
    values
        The names and values.
    writer
        Command that writes such files.
    """

    name: str
    values: Mapping[str, Any]
    writer: str

    def number(self, name: str, least: float = -math.inf, most: float = math.inf) -> float:
        """Return a finite number within limits."""
        found = self.number_or_none(name, least, most)
        if found is None:
            raise InputError(f"{self.name}: has no number '{name}'; `{self.writer}` writes one")
        return found

    def number_or_none(
        self, name: str, least: float = -math.inf, most: float = math.inf
    ) -> float | None:
        """Return a finite number within limits, or None where the file has none."""
        value = self.values.get(name)
        if value is None:
            return None
        if (found := finite(self.values, name)) is None:
            raise InputError(f"{self.name}: '{name}' is {_shown(value)}; a number is needed")
        if not least <= found <= most:
            raise InputError(
                f"{self.name}: '{name}' is {found:g}; a number {_limits(least, most)} is needed"
            )
        return found

    def count_or_none(self, name: str) -> int | None:
        """Return a whole number of 0 or more, or None where the file has none."""
        value = self.values.get(name)
        if value is None or (isinstance(value, int) and not isinstance(value, bool) and value >= 0):
            return value
        raise InputError(f"{self.name}: '{name}' is {_shown(value)}; a whole number is needed")

    def word(self, name: str, otherwise: str, known: Sequence[str] = ()) -> str:
        """Return a word, which must be one of the known ones if there are any."""
        value = self.values.get(name, otherwise)
        if not isinstance(value, str) or (known and value not in known):
            needed = " or ".join(known) or "a word"
            raise InputError(f"{self.name}: '{name}' is {_shown(value)}; {needed} is needed")
        return value

    def truth(self, name: str, otherwise: bool = False) -> bool:
        """Return true or false."""
        value = self.values.get(name, otherwise)
        if not isinstance(value, bool):
            raise InputError(f"{self.name}: '{name}' is {_shown(value)}; true or false is needed")
        return value

    def entries(self, name: str) -> list[Any]:
        """Return a list, which is empty where the file has none."""
        value = self.values.get(name, [])
        if not isinstance(value, list):
            raise InputError(f"{self.name}: '{name}' is {_shown(value)}; a list is needed")
        return value


def _shown(value: object) -> str:
    """Return a value as JSON, cut after some characters."""
    text = json.dumps(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _limits(least: float, most: float) -> str:
    return f"of {least:g} or more" if most == math.inf else f"between {least:g} and {most:g}"


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
