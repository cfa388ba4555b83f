"""A catalogue from any form in which it may be given."""

from pathlib import Path
from typing import TypeAlias

from astropy.table import Table

from uvshear.errors import InputError
from uvshear.io.catalogue import Catalogue, catalogue_from_table, catalogue_table, read_catalogue

CatalogueLike: TypeAlias = Catalogue | Table | str | Path
"""A catalogue, a table with its columns, or the file that has it."""


def catalogue_of(given: CatalogueLike) -> Catalogue:
    """Return a catalogue, which may be given as an object, as a table, or as the path of a file."""
    if isinstance(given, Catalogue):
        if len(given):
            catalogue_from_table(catalogue_table(given))  # for its checks
        return given
    if isinstance(given, Table):
        return catalogue_from_table(given)
    if isinstance(given, str | Path):
        return read_catalogue(given)
    raise InputError(
        f"{type(given).__name__}: a Catalogue, an astropy Table, or the path of one is needed"
    )
