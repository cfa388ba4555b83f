"""Compressed files, decompressed into memory up to a limit."""

import bz2
import gzip
import lzma
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

from uvshear.errors import InputError

LARGEST: Final = 2_000_000_000
"""Most bytes that a compressed file may hold. A list of PyBDSF needs 345 bytes for a source, so that this is a list of
5 million; a larger one must be decompressed by the user, whose disk is then the limit."""

ALWAYS: Final = 64_000_000
"""Bytes that a compressed file may hold whatever its own size."""

RATIO: Final = 100
"""Largest ratio of the sizes beyond ``ALWAYS``. Catalogues were compressed by 2 to 20 (a list of PyBDSF in FITS by 2.9,
the same list as text by 3.4), and a file of zeros by 1000."""

_STEP: Final = 1 << 20

_OPENERS: Mapping[bytes, tuple[str, Callable[[Path], Any]]] = {
    b"\x1f\x8b": ("gzip", gzip.open),
    b"BZh": ("bzip2", bz2.open),
    b"\xfd7zXZ\x00": ("xz", lzma.open),
}

_UNREADABLE: Mapping[bytes, str] = {
    b"PK\x03\x04": "a zip archive",
    b"\x1f\x9d": "compressed by compress (.Z)",
    b"\x28\xb5\x2f\xfd": "compressed by zstd",
    b"7z\xbc\xaf\x27\x1c": "a 7z archive",
    b"\x89HDF": "an HDF5 file",
    b"PAR1": "a Parquet file",
}


def decompressed(path: Path) -> bytes | None:
    """Return what a compressed file holds; None where the file is not compressed.

    Raises
    ------
    InputError
        The file is damaged, holds more than the limits allow, or has a format that cannot be read.
    """
    with path.open("rb") as file:
        start = file.read(6)
    for magic, name in _UNREADABLE.items():
        if start.startswith(magic):
            raise InputError(f"{path}: is {name}; unpack it or convert it to FITS, ECSV or CSV")
    for magic, (name, opener) in _OPENERS.items():
        if start.startswith(magic):
            return _read(path, name, opener)
    return None


def _read(path: Path, name: str, opener: Callable[[Path], Any]) -> bytes:
    limit = min(LARGEST, max(ALWAYS, RATIO * path.stat().st_size))
    content = bytearray()
    try:
        with opener(path) as file:
            while step := file.read(_STEP):
                content += step
                if len(content) > limit:
                    raise InputError(
                        f"{path}: holds more than {limit / 1e6:.0f} MB in {path.stat().st_size / 1e6:.3g} MB of {name};"
                        " if this is what it should be, decompress it first"
                    )
    except (OSError, EOFError, zlib.error, lzma.LZMAError) as error:
        raise InputError(
            f"{path}: cannot be decompressed: the {name} data are damaged or cut short ({error})"
        ) from error
    return bytes(content)
