"""Room on a disk, which is looked for before the work whose result needs it."""

import shutil
from pathlib import Path

from uvshear.errors import InputError


def require_space(path: Path, needed: float) -> None:
    """Refuse an output for which the disk has too little room.

    Parameters
    ----------
    path
        Output, in a directory that exists.
    needed
        Size of the output [bytes].
    """
    free = shutil.disk_usage(path.parent).free
    if needed > free:
        raise InputError(
            f"{path}: needs {needed / 1e6:.4g} MB, but its disk has only {free / 1e6:.4g} MB left; make room, or write"
            " elsewhere"
        )
