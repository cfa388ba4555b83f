"""The command line, with one file for each command; all its work can be done from Python as well.

``application`` reports a wrong input in one line, ``options`` checks numbers before any computation,
and ``terminal`` prints. Commands import heavy modules only when they run, so that help is instant.
"""

from uvshear.cli.application import main

__all__ = ["main"]
