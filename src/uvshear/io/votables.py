"""Tables of VOTable files, with the coordinate system of each column."""

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from astropy.io.votable import parse
from astropy.table import Table

from uvshear.io.table_choice import TableEntry, chosen_table

COORDINATE_SYSTEM = "coordinate_system"
"""Key of a column's metadata: system and equinox of the COOSYS element to which it refers."""


def read_votable(
    path: Path,
    content: bytes | None,
    choice: str | None = None,
    suits: Callable[[Sequence[str]], bool] | None = None,
) -> Table:
    """Read a table of a VOTable, whose columns have their names and not their XML identifiers.

    Parameters
    ----------
    path
        The file, for messages, and to be read unless its content is given.
    content
        The decompressed file.
    choice, suits
        See :func:`~uvshear.io.table_choice.chosen_table`.
    """
    document = parse(path if content is None else io.BytesIO(content), verify="ignore")
    found = list(document.iter_tables())
    entries = [
        TableEntry(number, table.name or table.ID or "", table.nrows, _names(table))
        for number, table in enumerate(found, 1)
    ]
    chosen = found[chosen_table(path, entries, choice, suits).number - 1]
    table = chosen.to_table(use_names_over_ids=True)
    systems = {system.ID: system for system in document.iter_coosys()}
    # A single system needs no reference, as old files have it.
    usual = next(iter(systems.values())) if len(systems) == 1 else None
    for name, field in zip(table.colnames, chosen.fields, strict=True):
        if (system := systems.get(field.ref, usual)) is not None:
            table[name].info.meta = {COORDINATE_SYSTEM: (system.system, system.equinox)}
    return table


def _names(table: Any) -> tuple[str, ...]:
    return tuple(field.name or field.ID for field in table.fields)
