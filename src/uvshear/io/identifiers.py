"""Identifiers that every format of tables can hold."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Shaped

OTHER_NAMES: Final = ("Source_Name", "Source_id", "Gaus_id", "uuid")
"""Names that archives and source finders give to the column of identifiers; the first that a table has is used."""


def identifiers_among(names: Sequence[str]) -> str | None:
    """Return the column of identifiers in a table without a column ``id``; None if it has ``id``, or no such column."""
    by_word = {name.lower(): name for name in reversed(names)}
    if "id" in by_word:
        return None
    return next((by_word[other.lower()] for other in OTHER_NAMES if other.lower() in by_word), None)


def check_identifiers(identifier: Shaped[Array, " source"]) -> None:
    """Refuse identifiers that a file of shapes, of statistics or of the fitted sky cannot hold.

    FITS has ASCII alone. A line of ECSV that begins with ``#`` is a comment, and would be lost.

    Parameters
    ----------
    identifier
        Identifiers of a catalogue's sources: numbers or text.
    """
    if identifier.dtype.kind in "iu":
        return
    for row, name in enumerate(np.asarray(identifier, str).tolist(), 1):
        if name.isascii() and name.isprintable() and not name.startswith("#"):
            continue
        if name.startswith("#"):
            raise InputError(
                f"the catalogue's identifier {name!a} in row {row} begins with '#', which marks a comment in ECSV;"
                " another identifier is needed"
            )
        wrong = next(letter for letter in name if not (letter.isascii() and letter.isprintable()))
        raise InputError(
            f"the catalogue's identifier {name!a} in row {row} has the character U+{ord(wrong):04X}, which tables in"
            " FITS cannot hold; identifiers of printable ASCII characters are needed"
        )
