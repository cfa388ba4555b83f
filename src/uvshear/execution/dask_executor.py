"""Tasks on the workers of a Dask cluster."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from uvshear.execution.cores import in_copies
from uvshear.execution.crew import Crew, Data, Result, Shared, Task
from uvshear.execution.dask_calls import DaskCall
from uvshear.execution.dask_sums import DaskSum
from uvshear.execution.executor import Executor
from uvshear.execution.serial import Serial


@dataclass(frozen=True)
class Dask(Executor):
    """Runs the tasks of :meth:`distribute` on the workers of a Dask cluster, and all others on this machine.

    Tasks that share memory (:meth:`map`, :meth:`crew`) run on this machine's own cores. On a worker, where the executor
    may arrive as a part of an object, it is ``Serial``.

    Parameters
    ----------
    client
        A ``distributed.Client``, which must reach the workers and not only the scheduler.
    local
        Executor of this machine's cores; copies of the process on all of them unless given.
    """

    client: Any
    local: Executor = field(default_factory=in_copies)

    @property
    def workers(self) -> int:
        """Number of tasks of :meth:`map` that run at the same time, on this machine."""
        return self.local.workers

    @property
    def distributed_workers(self) -> int:
        """Number of threads of all workers of the cluster, and at least one."""
        return max(1, sum(self.client.nthreads().values()))

    def at_most(self, workers: int) -> Executor:
        """Return an executor that does at most this number of tasks at a time on this machine."""
        return replace(self, local=self.local.at_most(workers))

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the results, from this machine."""
        return self.local.map(function, tasks)

    def distribute(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        tasks: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield the results, from the workers of the cluster.

        A worker that is lost costs only its tasks, which others do again. Small tasks are sent in batches.
        """
        return DaskCall(self.client, function, shared).results(tasks)

    def in_partitions(
        self,
        read: Callable[[Task], Data],
        function: Callable[[Shared, Task, Data], Result],
        shared: Shared,
        partitions: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield the results, from the workers of the cluster, which read the partitions."""
        there = partial(_read_there, read, function)
        return DaskCall(self.client, there, shared, most_in_a_batch=1).results(partitions)

    def sum_partitions(
        self,
        function: Callable[[Shared, Task], Result],
        add: Callable[[Result, Result], Result],
        shared: Shared,
        partitions: Iterable[Task],
    ) -> Result:
        """Return the sum, which the workers of the cluster have added up."""
        found: Result = DaskSum(self.client, function, add, shared).total(partitions)
        return found

    def crew(self, shared: Shared) -> AbstractContextManager[Crew[Shared]]:
        """Return workers on this machine."""
        return self.local.crew(shared)

    @contextmanager
    def lasting(self) -> Iterator[Executor]:
        """Yield an executor whose crews on this machine last until the end of the block."""
        with self.local.lasting() as local:
            yield replace(self, local=local)

    def __reduce__(self) -> tuple[Any, ...]:
        return Serial, ()


def _read_there(
    read: Callable[[Task], Data],
    function: Callable[[Shared, Task, Data], Result],
    shared: Shared,
    partition: Task,
) -> Result:
    return function(shared, partition, read(partition))
