"""The command line, one file a command; everything it does is callable from the package.

``application`` turns what goes wrong into one line, ``options`` checks numbers before computing
starts, ``terminal`` speaks to the user. Commands import what is heavy when run: help is instant.
"""

from uvshear.cli.application import main

__all__ = ["main"]
