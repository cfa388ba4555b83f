"""What goes wrong with a Dask cluster, in one line."""

from collections.abc import Iterator
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager
from typing import Any


class ClusterLost(BrokenExecutor):
    """A cluster, or all of its workers, ended before the work was done; the message is one line."""


@contextmanager
def lost_by(client: Any) -> Iterator[None]:
    """Raise ``ClusterLost`` for errors that say that the scheduler or the workers of a client have been lost."""
    from distributed import KilledWorker  # noqa: PLC0415 - Dask is optional
    from distributed.client import FutureCancelledError  # noqa: PLC0415
    from distributed.comm.core import CommClosedError  # noqa: PLC0415

    try:
        yield
    except KilledWorker as error:
        count = error.allowed_failures + 1
        raise ClusterLost(
            f"{count} worker{'s' * (count > 1)} of the cluster ended during the same task; the system may have killed"
            " them for lack of memory"
        ) from error
    except FutureCancelledError as error:
        if client.status == "running":
            raise
        raise ClusterLost(_NO_ANSWER) from error
    except (OSError, CommClosedError, RuntimeError) as error:
        is_up = client.status == "running"
        raise ClusterLost(_NO_WORKER if is_up else _NO_ANSWER) from error


_NO_ANSWER = "the scheduler of the cluster no longer answers"
_NO_WORKER = "no worker of the cluster can be reached from this machine"
