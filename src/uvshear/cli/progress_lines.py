"""Progress where there is no terminal: a line a minute."""

from collections.abc import Mapping
from typing import Final

import typer

from uvshear.cli.progress_text import line_about
from uvshear.progress import Course, Observer, Stage

EVERY: Final = 60.0
"""Time between lines, and before the first one [s]."""


class ProgressLines(Observer):
    """Shows a line about a course on standard error, with the first report of each minute but the first.

    Parameters
    ----------
    description
        What is being done.
    course
        The course, which has heard of each report before.
    """

    def __init__(self, description: str, course: Course) -> None:
        self._description, self._course = description, course
        self._due = EVERY

    def begin(self, stage: Stage, *then: Stage) -> None:
        """Show a line if it is time."""
        self._show_if_due()

    def advance(self, done: float, expected: float) -> None:
        """Show a line if it is time."""
        self._show_if_due()

    def foresee(self, *then: Stage) -> None:
        """Do nothing: the course has heard of it."""

    def note(self, facts: Mapping[str, object]) -> None:
        """Do nothing: a line tells of times alone."""

    def finish(self) -> None:
        """Do nothing: the results tell that the work is done."""

    def _show_if_due(self) -> None:
        elapsed = self._course.elapsed
        if elapsed >= self._due:
            self._due = (elapsed // EVERY + 1) * EVERY
            typer.echo(line_about(self._description, self._course), err=True)
