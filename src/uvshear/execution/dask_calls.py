"""One call of ``Dask.distribute``: its shared object is placed on the workers, and its tasks are sent in batches.

The scheduler sees only small tasks. The shared object goes from this process to one worker, and from worker to worker;
results come from the workers directly.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from operator import length_hint
from queue import Empty, SimpleQueue
from typing import Any, Final

from uvshear.execution.dask_errors import ClusterLost, lost_by
from uvshear.execution.dask_worker import Answers, version, work
from uvshear.execution.messages import packed
from uvshear.execution.parcel import Parcel

QUEUED: Final = 2
"""Number of batches that a worker has at a time: one to work on, and the next."""

AHEAD: Final = 4
"""Largest number of batches per worker that are begun or finished while the oldest result has not been yielded."""

WORTH_A_BATCH: Final = 0.5
"""Work that a batch of small tasks should be [s]. A scheduler takes about a millisecond for a batch, so that it serves
some hundred workers."""

MOST_IN_A_BATCH: Final = 256
"""Largest number of tasks in a batch."""

WAKE: Final = 0.2
"""Longest time in which this process, while it waits for a worker, does not notice an interruption [s]."""

WAIT_FOR_WORKERS: Final = 60.0
"""Time that the cluster has to start a worker when none is left [s]."""

MOST_PLACINGS: Final = 4
"""Number of times that the shared object is placed anew, after all workers that held it were lost, before the call is
given up."""

_last_duration: dict[Callable[..., Any], float] = {}
"""Duration of a task in the last batch of each function [s]."""


@dataclass(eq=False)
class _Batch:
    """Tasks that are sent together, and what became of them once it is known."""

    tasks: list[Any]
    answers: Answers | None = None


class DaskCall:
    """A function and a shared object, whose tasks the workers of a cluster do.

    Parameters
    ----------
    client
        A ``distributed.Client``.
    function
        Function of the shared object and a task.
    shared
        The object that the tasks use.
    most_in_a_batch
        Largest number of tasks in a batch.
    """

    def __init__(
        self,
        client: Any,
        function: Callable[..., Any],
        shared: Any,
        *,
        most_in_a_batch: int = MOST_IN_A_BATCH,
    ) -> None:
        self._client, self._function, self._most = client, function, most_in_a_batch
        self._parcel = Parcel.packed(shared)
        self._version = version()
        self._held: Any = None
        self._placings = 0
        self._begun: dict[Any, _Batch] = {}
        self._futures: dict[Any, Any] = {}
        self._ended = SimpleQueue[Any]()

    def results(self, tasks: Iterable[Any]) -> Iterator[Any]:
        """Yield the results in the order of the tasks."""
        waiting, left = iter(tasks), length_hint(tasks, 0)
        in_order = deque[_Batch]()
        try:
            workers = self._place()
            while True:
                while len(self._begun) < QUEUED * workers and len(in_order) < AHEAD * workers:
                    batch = _Batch(list(islice(waiting, self._batch_size(left, workers))))
                    if not batch.tasks:
                        break
                    left -= len(batch.tasks)
                    in_order.append(batch)
                    self._begin(batch)
                if not in_order:
                    return
                workers = self._collect(workers)
                while in_order and (answers := in_order[0].answers) is not None:
                    in_order.popleft()
                    yield from answers.results
                    if answers.error is not None:
                        raise answers.error
        finally:
            self._end()

    def _batch_size(self, left: int, workers: int) -> int:
        """Choose the number of tasks in the next batch; batches shrink, so that all workers end at about the same time.

        The tasks of a generator, whose number is not known, may be large; they are sent one by one.
        """
        seconds = _last_duration.get(self._function)
        if seconds is None or left <= 0:
            return 1
        worthwhile = int(WORTH_A_BATCH / max(seconds, 1e-6))
        return max(1, min(worthwhile, left // (2 * QUEUED * workers), self._most))

    def _place(self) -> int:
        self._held, workers = place(self._client, self._parcel)
        return workers

    def _begin(self, batch: _Batch) -> None:
        asked = packed((self._function, batch.tasks))
        with lost_by(self._client):
            future = self._client.submit(work, self._version, self._held, asked, pure=False)
        self._begun[future.key], self._futures[future.key] = batch, future
        future.add_done_callback(self._ended.put)

    def _collect(self, workers: int) -> int:
        """Wait for batches that end, take their answers, and return the number of workers."""
        try:
            ended = [self._ended.get(timeout=WAKE)]
        except Empty:
            return workers
        while not self._ended.empty():
            ended.append(self._ended.get())
        ended = [future for future in ended if future.key in self._begun]
        good = [future for future in ended if future.status == "finished"]
        lost = [future for future in ended if future.status != "finished"]
        for future, parcel in zip(good, self._gathered(good), strict=True):
            if parcel is None:
                lost.append(future)
            else:
                self._take(future, parcel.content())
        for future in lost:
            if future.status == "error":
                with lost_by(self._client):
                    raise future.exception()
        if lost:
            return self._place_anew()
        return workers

    def _gathered(self, futures: list[Any]) -> list[Parcel | None]:
        """Return results, directly from the workers; None for one that was lost in the meantime."""
        from distributed.client import FutureCancelledError  # noqa: PLC0415 - Dask is optional

        try:
            with lost_by(self._client):
                return list(self._client.gather(futures, direct=True))
        except FutureCancelledError:
            found: list[Parcel | None] = []
            for future in futures:
                try:
                    found.append(self._client.gather(future, direct=True))
                except FutureCancelledError:
                    found.append(None)
            return found

    def _take(self, future: Any, answers: Answers) -> None:
        batch = self._begun.pop(future.key)
        del self._futures[future.key]
        batch.answers = answers
        if answers.results:
            _last_duration[self._function] = answers.seconds / len(answers.results)

    def _place_anew(self) -> int:
        """Place the shared object, which the cluster has lost with all workers that held it, and begin again."""
        self._placings += 1
        if self._placings > MOST_PLACINGS:
            raise ClusterLost("the workers of the cluster were lost again and again")
        batches = list(self._begun.values())
        self._end()
        workers = self._place()
        for batch in batches:
            self._begin(batch)
        return workers

    def _end(self) -> None:
        """Cancel what is left."""
        futures = list(self._futures.values())
        self._begun.clear()
        self._futures.clear()
        if self._client.status == "running":
            self._client.cancel(futures)
        self._held = None


def place(client: Any, parcel: Parcel) -> tuple[Any, int]:
    """Place an object on all workers; return its future, and the number of tasks that the workers do at a time."""
    with lost_by(client):
        client.wait_for_workers(1, timeout=WAIT_FOR_WORKERS)
        (held,) = client.scatter([parcel], direct=True, broadcast=True, hash=False)
        return held, max(1, sum(client.nthreads().values()))
