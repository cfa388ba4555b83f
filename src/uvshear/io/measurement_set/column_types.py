"""Types of the columns of the main table of a Measurement Set."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

from casacore import tables

from uvshear.errors import InputError

WHOLE: Final = frozenset({"uchar", "short", "ushort", "int", "uint", "int64"})
NUMBER: Final = WHOLE | {"float", "double"}

OF_ROWS: Final[Mapping[str, frozenset[str]]] = {
    "ANTENNA1": WHOLE,
    "ANTENNA2": WHOLE,
    "DATA_DESC_ID": WHOLE,
    "FIELD_ID": WHOLE,
    "SCAN_NUMBER": WHOLE,
    "TIME": NUMBER,
    "EXPOSURE": NUMBER,
    "INTERVAL": NUMBER,
    "FLAG_ROW": frozenset({"boolean"}),
}
"""Types of columns with one value for each row, as casacore calls them."""

OF_SAMPLES: Final[Mapping[str, frozenset[str]]] = {
    "UVW": NUMBER,
    "FLAG": frozenset({"boolean"}),
    "WEIGHT_SPECTRUM": NUMBER,
    "WEIGHT": NUMBER,
    "SIGMA": NUMBER,
}
"""Types of columns with an array for each row."""


def check_types(path: Path, main: tables.table) -> None:
    """Refuse columns whose data type, or kind of cell, is not that of a Measurement Set."""
    for known, what in ((OF_ROWS, "one value"), (OF_SAMPLES, "an array")):
        for name in known.keys() & set(main.colnames()):
            kind = str(main.coldatatype(name))
            is_scalar = bool(main.isscalarcol(name))
            if kind not in known[name] or is_scalar != (known is OF_ROWS):
                needed = "booleans" if "boolean" in known[name] else "numbers"
                held = "one" if is_scalar else "an array"
                raise InputError(
                    f"{path}: column {name} holds {held} of type {kind} for each row; {what} of {needed} is needed"
                )
