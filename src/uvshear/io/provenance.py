"""The origin of a file: command, inputs, options, version and date."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import version
from typing import ClassVar


@dataclass(frozen=True)
class Provenance:
    """The origin of a file.

    Parameters
    ----------
    command
        Command line, or name of the function.
    inputs
        Files that were read.
    options
        Options that shaped the result.
    """

    KEYS: ClassVar = ("version", "command", "inputs", "options", "date")
    """Names of the entries in the metadata of a table."""

    command: str
    inputs: tuple[str, ...] = ()
    options: Mapping[str, object] = field(default_factory=dict)

    def metadata(self) -> dict[str, str]:
        """Return short keys and ASCII text, which every table format keeps."""
        return {
            "version": f"uvshear {version('uvshear')}",
            "command": self.command.encode("ascii", "backslashreplace").decode(),
            "inputs": ascii_text(list(self.inputs)),
            "options": ascii_text(dict(self.options)),
            "date": _now(),
        }

    def record(self) -> dict[str, object]:
        """Return names and values for a JSON file."""
        return {
            "version": version("uvshear"),
            "command": self.command,
            "inputs": list(self.inputs),
            "options": json.loads(ascii_text(dict(self.options))),
            "date": _now(),
        }


def ascii_text(value: object) -> str:
    """Return numbers, text, lists and mappings as JSON in ASCII, which every table format keeps."""
    return json.dumps(value, default=str)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
