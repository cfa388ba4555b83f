"""What outputs contain, without the date and the command in them."""

import hashlib
import json
from pathlib import Path

import numpy as np
from astropy.table import Table
from casacore import tables

PROVENANCE = frozenset({"version", "command", "inputs", "date", "run", "seed", "seconds"})


def fingerprint(path: Path) -> str:
    """Return a hash of an output; reading it fails if it is not whole."""
    digest = hashlib.sha256()
    if path.is_dir():
        _measurement_set(path, digest)
    elif path.suffix == ".json":
        record = json.loads(path.read_text())
        digest.update(repr([(k, v) for k, v in record.items() if k not in PROVENANCE]).encode())
    elif path.suffix in {".fits", ".ecsv"} and "image" not in path.name:
        _table(Table.read(path), digest)
    elif path.suffix == ".fits":
        # The header has the command.
        digest.update(path.read_bytes()[-2880:])
    else:
        digest.update(path.read_bytes())
    return digest.hexdigest()


def run_of(path: Path) -> str | None:
    """Return the identity of the measurement in a table of FITS."""
    meta = {str(name).lower(): value for name, value in Table.read(path).meta.items()}
    return str(meta["run"]) if "run" in meta else None


def _table(table: Table, digest: "hashlib._Hash") -> None:
    for name in table.colnames:
        digest.update(name.encode())
        digest.update(repr(np.ma.filled(np.ma.asarray(table[name]), 0).tolist()).encode())


def _measurement_set(path: Path, digest: "hashlib._Hash") -> None:
    with tables.table(str(path), ack=False) as main:
        for name in ("UVW", "DATA", "FLAG", "WEIGHT", "TIME", "ANTENNA1", "ANTENNA2"):
            digest.update(np.ascontiguousarray(main.getcol(name)).tobytes())
        for keyword in main.getkeywords():
            if (path / keyword).is_dir():
                with tables.table(str(path / keyword), ack=False) as subtable:
                    digest.update(f"{keyword} {subtable.nrows()} {subtable.colnames()}".encode())
