"""The sum of the results of many partitions, which stay on the workers of a Dask cluster until they have been added."""

from collections.abc import Callable, Iterable, Sequence
from queue import Empty, SimpleQueue
from typing import Any

from uvshear.execution.dask_calls import MOST_PLACINGS, WAKE, place
from uvshear.execution.dask_errors import ClusterLost, lost_by
from uvshear.execution.dask_worker import add_up, version, work_on_partition
from uvshear.execution.messages import packed
from uvshear.execution.parcel import Parcel
from uvshear.execution.tree import tree_of


class DaskSum:
    """A function of a shared object and a partition, whose results are added up.

    Parameters
    ----------
    client
        A ``distributed.Client``.
    function
        Function of the shared object and a partition.
    add
        Function that adds a result to a sum, which it may change, and returns the sum.
    shared
        The object that all partitions use.
    """

    def __init__(
        self, client: Any, function: Callable[..., Any], add: Callable[..., Any], shared: Any
    ) -> None:
        self._client, self._function, self._add = client, packed(function), packed(add)
        self._parcel = Parcel.packed(shared)

    def total(self, partitions: Iterable[Any]) -> Any:
        """Return the sum over all partitions, in the order of ``tree_sum``."""
        tasks = [packed(partition) for partition in partitions]
        for _ in range(MOST_PLACINGS):
            root = self._begun(tasks)
            try:
                if (found := self._awaited(root)) is not None:
                    return found.content()
            finally:
                if self._client.status == "running":
                    self._client.cancel([root])
        raise ClusterLost("the workers of the cluster were lost again and again")

    def _begun(self, tasks: Sequence[bytes]) -> Any:
        """Return the future of the sum; nobody but the scheduler knows the others."""
        held, _ = place(self._client, self._parcel)

        def leaf(task: bytes) -> Any:
            return self._client.submit(
                work_on_partition, version(), held, self._function, task, pure=False
            )

        def join(group: Sequence[Any]) -> Any:
            return self._client.submit(add_up, self._add, list(group), pure=False)

        with lost_by(self._client):
            return tree_of([leaf(task) for task in tasks], join)

    def _awaited(self, root: Any) -> Parcel | None:
        """Wait for the sum; None where the cluster has lost what it needs for it."""
        from distributed.client import FutureCancelledError  # noqa: PLC0415 - Dask is optional

        ended = SimpleQueue[Any]()
        root.add_done_callback(ended.put)
        while True:
            try:
                ended.get(timeout=WAKE)
                break
            except Empty:
                continue
        try:
            with lost_by(self._client):
                if root.status == "error":
                    raise root.exception()
                found: Parcel = self._client.gather(root, direct=True)
                return found
        except FutureCancelledError:
            return None
