"""Tasks in forked worker processes, which this package calls copies of the process."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from uvshear.execution.copied_crew import CopiedCrew
from uvshear.execution.counted import Counted
from uvshear.execution.crew import Crew, Result, Shared, Task
from uvshear.execution.libraries import single_threaded_libraries
from uvshear.execution.threads import Threads


@dataclass(frozen=True)
class Copies(Counted):
    """Runs the tasks of :meth:`distribute` in this process and its copies, and those of :meth:`map` in threads.

    There are ``count`` threads, or ``count`` processes of which one is this process.
    """

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the results, from threads of this process."""
        return Threads(self.count).map(function, tasks)

    def distribute(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        tasks: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield the results; nothing but tasks and results is sent."""
        with self.crew(shared) as crew:
            yield from crew.map(function, tasks)

    @contextmanager
    def crew(self, shared: Shared) -> Iterator[Crew[Shared]]:
        """Yield this process and copies of it, which hold an object; libraries have one thread in each of them."""
        with single_threaded_libraries(), CopiedCrew(shared, self.count) as crew:
            yield crew
