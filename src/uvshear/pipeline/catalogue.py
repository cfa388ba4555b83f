"""A catalogue from whatever a user has of it."""

from pathlib import Path
from typing import TypeAlias

from astropy.table import Table

from uvshear.errors import InputError
from uvshear.io.catalogue import Catalogue, catalogue_from_table, read_catalogue

CatalogueLike: TypeAlias = Catalogue | Table | str | Path
"""A catalogue, a table with its columns, or the file that has it."""


def catalogue_of(given: CatalogueLike) -> Catalogue:
    """Return a catalogue from itself, from a table, or from a file."""
    if isinstance(given, Catalogue):
        return given
    if isinstance(given, Table):
        return catalogue_from_table(given)
    if isinstance(given, str | Path):
        return read_catalogue(given)
    raise InputError(
        f"{type(given).__name__}: a Catalogue, an astropy Table, or the path of one is needed"
    )
