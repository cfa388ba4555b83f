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
            "inputs": json.dumps(list(self.inputs)),
            "options": json.dumps(dict(self.options), default=str),
        }
