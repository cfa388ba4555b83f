"""Tasks in parallel processes, for work that holds Python's global interpreter lock."""

import os
import pickle
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing import active_children, get_context, parent_process, util
from multiprocessing.reduction import ForkingPickler
from typing import TYPE_CHECKING, Any

from uvshear.execution.counted import Counted
from uvshear.execution.crew import Result, Shared, Task
from uvshear.execution.libraries import limit_libraries
from uvshear.execution.ordered import ordered_results
from uvshear.execution.threads import Threads

if TYPE_CHECKING:
    from multiprocessing.queues import Queue


@dataclass(frozen=True)
class Processes(Counted):
    """Runs the tasks of :meth:`distribute` in ``count`` processes, and those of :meth:`map` in ``count`` threads."""

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the results, from threads of this process."""
        return Threads(self.count).map(function, tasks)

    def distribute(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        tasks: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield the results; each process gets ``shared`` when it starts."""
        context = get_context("spawn")
        # The shared object goes through a queue: as an argument, it would block this process until each new process has
        # imported the package.
        try:
            with _without_signals():
                job = context.Queue()
        except OSError:  # no room for semaphores in /dev/shm
            yield from Threads(self.count).distribute(function, shared, tasks)
            return
        content = bytes(ForkingPickler.dumps((function, shared)))
        for _ in range(self.count):
            job.put(content)
        try:
            with _Pool(self.count, context, _begin, (job,)) as pool:
                yield from ordered_results(pool, self.count, _work, tasks)
        finally:
            # Processes that were never started have left their copies of the shared object in the queue.
            job.cancel_join_thread()
            job.close()


def end_processes() -> None:
    """End the processes that work for this one, whatever they do, before this one ends without cleaning up."""
    for process in active_children():
        process.kill()
    # Otherwise Python's resource tracker would warn of leaked semaphores.
    util._run_finalizers(0)  # type: ignore[attr-defined]


@contextmanager
def _without_signals() -> Iterator[None]:
    """Block SIGINT and SIGHUP for processes that are started within: this process answers a terminal's signals."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGHUP))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Pool(ProcessPoolExecutor):
    """A pool whose processes start with SIGINT and SIGHUP blocked; ``submit`` starts them as they are needed."""

    def submit(self, *task: Any, **named: Any) -> Future[Any]:
        """Begin a task."""
        with _without_signals():
            return super().submit(*task, **named)


_job: list[Callable[[Any], Any]] = []


def _begin(job: "Queue[bytes]") -> None:
    threading.Thread(target=_end_with_parent, daemon=True).start()
    function, shared = pickle.loads(job.get())
    # Only now are the libraries loaded that the function needs.
    limit_libraries()
    _job[:] = [partial(function, shared)]


def _end_with_parent() -> None:
    """End this process when the one that started it has ended, however that was: nobody needs its results then."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _work(task: Any) -> Any:
    return _job[0](task)
