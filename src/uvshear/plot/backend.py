"""The import of matplotlib, whose pictures are drawn here without a backend for windows."""

import os
import sys
from contextlib import suppress
from importlib import import_module
from typing import Final

BACKEND: Final = "MPLBACKEND"
"""Variable of the environment that names a backend."""


def import_matplotlib() -> None:
    """Import matplotlib, even if the environment names a backend that it does not know.

    matplotlib refuses to be imported then, although figures that are only written to files need no backend. A name that
    it knows is heeded, for the figures of the user's own.
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
