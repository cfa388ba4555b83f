"""The import of matplotlib, which draws the pictures of this package without an interactive backend."""

import os
import sys
from contextlib import suppress
from importlib import import_module
from typing import Final

BACKEND: Final = "MPLBACKEND"
"""Variable of the environment that names a backend."""


def import_matplotlib() -> None:
    """Import matplotlib, even if the environment names a backend that it does not know.

    In that case the import of matplotlib fails, although figures that are only written to files need no backend. A
    backend that it knows is selected, for figures that the user draws.
    """
    if "matplotlib" in sys.modules:
        return
    named = os.environ.pop(BACKEND, None)
    try:
        matplotlib = import_module("matplotlib")
    finally:
        if named is not None:
            os.environ[BACKEND] = named
    if named:
        with suppress(ValueError):
            matplotlib.rcParams["backend"] = named


import_matplotlib()
