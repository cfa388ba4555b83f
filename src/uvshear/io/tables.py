"""Tables in files of any format that astropy knows."""

import warnings
from collections.abc import Mapping
from pathlib import Path

from astropy.table import Table

from uvshear.errors import InputError
from uvshear.io.outputs import new_file

WRITERS: Mapping[str, str] = {".ecsv": "ascii.ecsv", ".fits": "fits", ".vot": "votable"}
READERS: Mapping[str, str] = {
    ".ecsv": "ascii.ecsv",
    ".csv": "ascii.csv",
    ".fits": "fits",
    ".fit": "fits",
    ".vot": "votable",
    ".xml": "votable",
}


def read_table(path: Path, what: str) -> Table:
    """Read a table of any format; ``what`` describes the expected file in messages."""
    if not path.exists():
        raise InputError(f"{path}: no such file; a {what} is needed")
    if path.is_dir():
        raise InputError(f"{path}: is a directory; a {what} is needed (a table in one file)")
    if path.stat().st_size == 0:
        raise InputError(f"{path}: is empty; a {what} is needed")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return Table.read(path, format=READERS.get(path.suffix.lower()))
    except Exception as error:  # astropy's readers raise what they like
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(
            f"{path}: cannot be read as a table ({reason});"
            f" a {what} as ECSV, FITS, VOTable or CSV is needed"
        ) from error


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
