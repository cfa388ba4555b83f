"""Identifiers that every format of tables can hold."""

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Shaped


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
