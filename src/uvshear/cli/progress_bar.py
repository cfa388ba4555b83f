"""Progress on a terminal: a bar with the stage, its rate and the time that is left."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from uvshear.cli.progress_text import done_text, left_text, rate_text
from uvshear.progress import Course


@contextmanager
def live_bar(description: str, course: Course) -> Iterator[None]:
    """Show a bar on standard error, which follows a course until the block ends, and then disappears."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, ProgressColumn, Task
    from rich.table import Column
    from rich.text import Text

    class Words(ProgressColumn):
        """Words that are worked out each time the bar is drawn."""

        def __init__(self, words: Callable[[], str]) -> None:
            super().__init__(Column(no_wrap=True))
            self._words = words

        def render(self, task: Task) -> Text:
            """Return the words, and move the bar."""
            task.total, task.completed = (1.0, course.share) if course.share else (None, 0.0)
            return Text(self._words())

    columns = (
        Words(lambda: f"{description}: {course.stage}" if course.stage else description),
        BarColumn(20),
        Words(lambda: done_text(course)),
        Words(lambda: left_text(course)),
        # Its width changes most: here it moves nothing else.
        Words(lambda: rate_text(course)),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        bar.add_task(description, total=None)
        yield
