"""Tasks in forked worker processes, which this package calls copies of the process."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from uvshear.execution.copied_crew import CopiedCrew
from uvshear.execution.counted import Counted
from uvshear.execution.crew import Crew, Result, Shared, Task
from uvshear.execution.executor import Executor
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

    @contextmanager
    def lasting(self) -> Iterator[Executor]:
        """Yield an executor whose copies last until the end of the block: they are made once, and learn once."""
        from uvshear.execution.shared_memory import (  # noqa: PLC0415 - loads NumPy, help does not
            reserve_region,
        )

        if not reserve_region():
            yield self
            return
        with single_threaded_libraries(), CopiedCrew[Any](None, self.count) as crew:
            yield _LastingCopies(self.count, crew)


@dataclass(frozen=True)
class _LastingCopies(Copies):
    """An executor of which all crews are the same copies."""

    of_all: CopiedCrew[Any]

    def at_most(self, workers: int) -> Executor:
        """Return this executor if it has no more workers; otherwise one with copies of its own."""
        return self if workers >= self.count else Copies(self.count).at_most(workers)

    @contextmanager
    def crew(self, shared: Shared) -> Iterator[Crew[Shared]]:
        """Yield the copies, which hold the object until the end of the block; a crew within it has its own copies."""
        if self.of_all.holds_something:
            with super().crew(shared) as crew:
                yield crew
            return
        self.of_all.hold(shared)
        try:
            yield self.of_all
        finally:
            self.of_all.release()

    @contextmanager
    def lasting(self) -> Iterator[Executor]:
        """Yield this executor."""
        yield self
