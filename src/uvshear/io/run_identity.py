"""The identity of a measurement, which all of its files carry: files of different measurements are never mixed."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
from astropy.io import fits
from astropy.table import Table

RUN: Final = "run"
"""Key of the identity in the metadata of a table."""

LENGTH: Final = 16
"""Number of hexadecimal digits."""


EARLIER: Final = ("uvshear measure", "uvshear.measure", "uvshear demo")
"""Beginnings of the commands that wrote files without an identity."""


def run_of(table: Table) -> str | None:
    """Return the identity that a table carries; None where it carries none."""
    known = {str(name).lower(): value for name, value in table.meta.items()}
    return str(known[RUN]) if RUN in known else None


def new_run(shapes: Table, made: Mapping[str, str]) -> str:
    """Return the identity of a measurement, a hash of its provenance and of its shapes.

    The same inputs and options on the same day give the same identity, if they give the same shapes: their files may
    then be mixed without harm.
    """
    digest = hashlib.sha256(json.dumps(dict(sorted(made.items()))).encode())
    for name in shapes.colnames:
        values = np.ma.filled(
            np.ma.asarray(shapes[name]), *([0] if shapes[name].dtype.kind in "fiu" else [])
        )
        digest.update(name.encode())
        digest.update(repr(values.tolist()).encode())
    return digest.hexdigest()[:LENGTH]


def run_in_file(path: Path) -> str | None:
    """Return the identity in a FITS file that a measurement wrote; None for any other file.

    Files of earlier versions have no identity, and the word for theirs is empty.
    """
    try:
        header = fits.getheader(path, 1)
    except (OSError, IndexError, TypeError, ValueError):
        return None
    if RUN.upper() in header:
        return str(header[RUN.upper()])
    command = str(header.get("COMMAND", ""))
    return "" if command.startswith(EARLIER) else None


def companion(shapes: Path, kind: str) -> Path:
    """Return the name of a file that belongs to a table of shapes: NAME.kind.fits for NAME.fits.

    Tables in other formats keep their extension in it, so that NAME.ecsv does not share files with NAME.fits.
    """
    stem = shapes.stem if shapes.suffix.lower() == ".fits" else shapes.name
    return shapes.with_name(f"{stem}.{kind}.fits")
