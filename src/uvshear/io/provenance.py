"""What a table says about how it was made."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import version


@dataclass(frozen=True)
class Provenance:
    """How a table was made: the command, the files it read, the options that shaped it."""

    command: str
    inputs: tuple[str, ...] = ()
    options: Mapping[str, object] = field(default_factory=dict)

    def metadata(self) -> dict[str, str]:
        """Return it as short keys and ASCII text, which every table format keeps."""
        return {
            "version": f"uvshear {version('uvshear')}",
            "command": self.command.encode("ascii", "backslashreplace").decode(),
            "inputs": ascii_text(list(self.inputs)),
            "options": ascii_text(dict(self.options)),
        }


def ascii_text(value: object) -> str:
    """Numbers, words, lists and mappings as JSON in ASCII, which every table format keeps."""
    return json.dumps(value, default=str)
