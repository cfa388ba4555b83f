"""The report of a command about its progress: a bar on a terminal, a line a minute elsewhere, and a log."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from uvshear.cli.options import provenance
from uvshear.cli.panels import OUTPUT
from uvshear.cli.progress_bar import live_bar
from uvshear.cli.progress_lines import ProgressLines
from uvshear.cli.terminal import warn
from uvshear.progress import Course, Observer, Observers

LogOption = Annotated[
    Path | None,
    typer.Option(
        "--log",
        metavar="FILE",
        rich_help_panel=OUTPUT,
        help="Log file, to which a line in JSON is written at the end of each stage of the work: its duration, its CPU"
        " time, its memory and, for minor cycles, the convergence.",
        show_default=False,
    ),
]


@contextmanager
def progress_report(description: str, log: Observer | None = None) -> Iterator[Observer]:
    """Yield an observer of long work, which shows its progress on standard error.

    Parameters
    ----------
    description
        What is being done.
    log
        Another observer, which is told of everything as well.
    """
    course = Course()
    observers = [course] if log is None else [course, log]
    # rich takes other outputs for terminals as well where the environment has FORCE_COLOR.
    if sys.stderr.isatty():
        with live_bar(description, course):
            yield Observers(*observers)
    else:
        yield Observers(*observers, ProgressLines(description, course))


def checked_log(path: Path | None, *, overwrite: bool, appends: bool = False) -> list[Path]:
    """Return the path of a log, if there is to be one; refuse one that cannot be written."""
    if path is None:
        return []
    from uvshear.io.run_log import check_log

    check_log(path, overwrite=overwrite, appends=appends)
    return [path]


def begin_log(
    context: typer.Context,
    path: Path | None,
    inputs: Sequence[Path],
    *,
    overwrite: bool,
    appends: bool = False,
) -> Observer | None:
    """Begin the log of a command, which ends with the command; return None where none is asked for."""
    if path is None:
        return None
    from uvshear.io.run_log import run_log

    made = provenance(context, *inputs)
    begun = run_log(path, made, overwrite=overwrite, appends=appends, on_failure=warn)
    log: Observer = context.with_resource(begun)
    return log
