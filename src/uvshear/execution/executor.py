"""The base class of executors: tasks in parallel, with results in the order of the tasks."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext

from uvshear.execution.crew import Crew, Data, LocalCrew, Result, Shared, Task
from uvshear.execution.tree import tree_sum


class Executor(ABC):
    """Runs tasks in parallel.

    A task of :meth:`map` may wait for earlier tasks of the same call (``Promise``). An executor therefore begins them
    in their order. Tasks of :meth:`distribute` and of crews do not depend on one another.

    Results come in the order of the tasks, so that a sum of them is the same, bit for bit, whatever the executor and
    however many workers it has.
    """

    @property
    @abstractmethod
    def workers(self) -> int:
        """Number of tasks that run at the same time on this machine."""

    @property
    def distributed_workers(self) -> int:
        """Number of tasks of :meth:`distribute` that run at the same time, on whatever machines."""
        return self.workers

    @abstractmethod
    def at_most(self, workers: int) -> "Executor":
        """Return an executor of this kind with at most this number of workers, for tasks that each need much memory."""

    @abstractmethod
    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield ``function(task)`` for every task; all tasks share the memory of this process.

        Tasks are taken from the iterable a few at a time, so that a generator of large tasks is never held as a whole.
        """

    def map_in_batches(
        self, function: Callable[[Task], Result], tasks: Sequence[Task], batch: int
    ) -> Iterator[Result]:
        """Do the same as :meth:`map`, with batches of small tasks: a worker takes ``batch`` tasks at a time."""

        def of_batch(first: int) -> list[Result]:
            return [function(task) for task in tasks[first : first + batch]]

        for results in self.map(of_batch, range(0, len(tasks), batch)):
            yield from results

    @abstractmethod
    def distribute(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        tasks: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield ``function(shared, task)`` for every task, which may run in another process.

        ``function`` is defined at the top level of a module, so that it can be pickled. ``shared`` is sent to each
        worker once. Tasks and results are picklable.
        """

    def in_partitions(
        self,
        read: Callable[[Task], Data],
        function: Callable[[Shared, Task, Data], Result],
        shared: Shared,
        partitions: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield ``function(shared, partition, read(partition))`` for every partition of data in files.

        Unless a subclass overrides this method, the caller reads ahead while the workers of :meth:`map` work. On a
        cluster each worker reads. Both functions are defined at the top level of a module; ``shared``, partitions and
        results are picklable.
        """
        tasks = ((partition, read(partition)) for partition in partitions)
        return self.map(lambda task: function(shared, *task), tasks)

    def sum_partitions(
        self,
        function: Callable[[Shared, Task], Result],
        add: Callable[[Result, Result], Result],
        shared: Shared,
        partitions: Iterable[Task],
    ) -> Result:
        """Add up ``function(shared, partition)`` for one or more partitions, in the order of ``tree_sum``.

        ``add(total, more)`` may change the total and return it. Unless a subclass overrides this method, one partition
        follows the other in this process, and it is for the function to occupy the workers of this executor, which
        ``shared`` may contain. On a cluster each partition occupies one worker, which reads it; the workers add, and
        send only the sum.
        """
        return tree_sum((function(shared, partition) for partition in partitions), add)

    def crew(self, shared: Shared) -> AbstractContextManager[Crew[Shared]]:
        """Return workers that hold an object and are told how it changes.

        Unless a subclass overrides this method, they are the workers of :meth:`map` and use the object itself.
        """
        return nullcontext(LocalCrew(shared, self.map))

    def lasting(self) -> AbstractContextManager["Executor"]:
        """Return an executor whose crews have the same workers until the end of the block.

        Unless a subclass overrides this method, it is the executor itself.
        """
        return nullcontext(self)
