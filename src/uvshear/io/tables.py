"""Tables in files of any format that astropy knows, compressed or not."""

import io
import warnings
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from astropy.io import fits
from astropy.table import Column, MaskedColumn, Table

from uvshear.errors import DataWarning, InputError
from uvshear.io.decompression import decompressed
from uvshear.io.outputs import new_file
from uvshear.io.table_choice import TableEntry, chosen_table, file_and_choice
from uvshear.io.text_tables import read_text
from uvshear.io.votables import read_votable

WRITERS: Mapping[str, str] = {".ecsv": "ascii.ecsv", ".fits": "fits", ".vot": "votable"}

_FITS: Final = frozenset({".fits", ".fit", ".fts"})
_VOTABLE: Final = frozenset({".vot", ".xml", ".votable"})
_COMPRESSED: Final = frozenset({".gz", ".bz2", ".xz", ".fz"})


@dataclass(frozen=True)
class Wanted:
    """Table that is wanted from a file.

    Parameters
    ----------
    what
        Description of the expected file in messages.
    suits
        Whether a table with these columns is the one; of several tables in a file, the first is taken without it.
    texts
        Columns that stay text in formats without types, whatever their cells look like.
    """

    what: str
    suits: Callable[[Sequence[str]], bool] | None = None
    texts: Collection[str] = ()


def read_table(path: Path, wanted: Wanted | str) -> Table:
    """Read a table of any format, from ``FILE`` or as ``FILE[2]`` or ``FILE[NAME]`` from a file with several tables.

    Parameters
    ----------
    path
        The file; ``.gz``, ``.bz2`` and ``.xz`` are decompressed in memory.
    wanted
        The table, or a description of the expected file.
    """
    if isinstance(wanted, str):
        wanted = Wanted(wanted)
    what = wanted.what
    file, choice = file_and_choice(path)
    if not file.exists():
        raise InputError(f"{path}: no such file; a {what} is needed")
    if file.is_dir():
        raise InputError(f"{path}: is a directory; a {what} is needed (a table in one file)")
    if file.is_file() and file.stat().st_size == 0:
        raise InputError(f"{path}: is empty; a {what} is needed")
    try:
        with warnings.catch_warnings():
            # Notes of readers are of no use to the user, but ours are.
            warnings.simplefilter("ignore")
            warnings.simplefilter("always", DataWarning)
            return _read(file, choice, wanted)
    except InputError as error:
        if str(error).startswith(str(file)):
            raise
        raise InputError(
            f"{path}: cannot be read as a table: {error}; a {what} is needed"
        ) from error
    except Exception as error:  # astropy's readers raise what they like
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(
            f"{path}: cannot be read as a table ({reason});"
            f" a {what} as ECSV, FITS, VOTable or CSV is needed"
        ) from error


def _read(file: Path, choice: str | None, wanted: Wanted) -> Table:
    content = decompressed(file)
    suffixes = [suffix.lower() for suffix in file.suffixes]
    while suffixes and suffixes[-1] in _COMPRESSED:
        suffixes.pop()
    suffix = suffixes[-1] if suffixes else ""
    start = content[:512] if content is not None else _start(file)
    if suffix in _FITS or start.startswith(b"SIMPLE  ="):
        return _read_fits(file, content, choice, wanted)
    if suffix in _VOTABLE or b"<VOTABLE" in start or start.lstrip().startswith(b"<?xml"):
        return read_votable(file, content, choice, wanted.suits)
    if choice is not None:
        raise InputError(f"{file}[{choice}]: a text file has only one table; give {file.name}")
    if suffix == ".ecsv" and not start.lstrip(b"\xef\xbb\xbf").startswith(b"# %ECSV"):
        raise InputError("its first line is not that of ECSV (# %ECSV 1.0)")
    return read_text(file.read_bytes() if content is None else content, wanted.texts)


def _start(file: Path) -> bytes:
    with file.open("rb") as opened:
        return opened.read(512)


def _read_fits(file: Path, content: bytes | None, choice: str | None, wanted: Wanted) -> Table:
    source = file if content is None else io.BytesIO(content)
    with fits.open(source, character_as_bytes=True) as extensions:
        entries = [
            TableEntry(
                number, extension.name, extension.header["NAXIS2"], tuple(extension.columns.names)
            )
            for number, extension in enumerate(extensions)
            if isinstance(extension, fits.BinTableHDU | fits.TableHDU)
        ]
        chosen = chosen_table(file, entries, choice, wanted.suits)
        table = Table.read(extensions[chosen.number])
    for name in table.colnames:
        if table[name].dtype.kind == "S":
            # What is not text stays bytes, and is refused where the column is needed.
            with suppress(UnicodeDecodeError):
                table[name] = _decoded(table[name])
    return table


def _decoded(column: Column) -> Column:
    """Return the text of a column of bytes, without the blanks that fill it up."""
    text = np.char.rstrip(np.char.decode(np.asarray(column), "utf-8"))
    mask = {"mask": column.mask} if isinstance(column, MaskedColumn) else {}
    return type(column)(text, unit=column.unit, description=column.description, **mask)


def check_table_name(path: Path) -> None:
    """Refuse a name whose extension belongs to no format that can be written."""
    if path.suffix.lower() not in WRITERS:
        raise InputError(
            f"{path}: the extension must name the format of the table: {', '.join(WRITERS)}"
        )


def write_table(path: Path, table: Table, *, overwrite: bool = False) -> None:
    """Write a table completely or not at all, in the format of its extension."""
    check_table_name(path)
    with new_file(path, overwrite=overwrite) as temporary, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # FITS: keys longer than 8 characters become HIERARCH cards
        table.write(temporary, format=WRITERS[path.suffix.lower()])
