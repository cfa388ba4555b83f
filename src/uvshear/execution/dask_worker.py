"""The part of a distributed call that runs on the workers of a Dask cluster."""

import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, reduce
from typing import Any

from uvshear.errors import InputError
from uvshear.execution.libraries import limit_libraries, start_libraries_with_one_thread
from uvshear.execution.parcel import Parcel


@dataclass(frozen=True)
class Answers:
    """What became of some tasks; none are done after one that has failed.

    Parameters
    ----------
    results
        Results of the tasks.
    error
        Error of the task after them; None if all have results.
    seconds
        Duration of all of them [s].
    """

    results: Sequence[Any]
    error: Exception | None
    seconds: float


def version() -> str:
    """Return the version of the package that is installed where this runs."""
    # The package as a whole is above this layer, so that it is not imported here.
    return str(sys.modules["uvshear"].__version__)


def work(expected: str, held: Parcel, asked: bytes) -> Parcel:
    """Do some tasks on a worker.

    Parameters
    ----------
    expected
        Version of the package that the client has.
    held
        The object that all tasks use.
    asked
        The function and the tasks, pickled.

    Returns
    -------
    Parcel
        The ``Answers``.
    """
    start = time.perf_counter()
    results: list[Any] = []
    error: Exception | None = None
    try:
        check_version(version(), expected)
        function, tasks = unpacked(asked)
        shared = unpacked(held)
        _prepare()
        for task in tasks:
            results.append(function(shared, task))
    except Exception as failure:
        error = failure
    return Parcel.packed(Answers(results, error, time.perf_counter() - start))


def work_on_partition(expected: str, held: Parcel, function: bytes, partition: bytes) -> Parcel:
    """Return the result of one partition, which stays on this worker until it is added to others."""
    check_version(version(), expected)
    _prepare()
    return Parcel.packed(unpacked(function)(unpacked(held), unpacked(partition)))


def add_up(add: bytes, results: Sequence[Parcel]) -> Parcel:
    """Add up results in their order. The results themselves stay as they are: they may be needed again."""
    added = unpacked(add)
    return Parcel.packed(reduce(added, (each.content() for each in results[1:]), results[0].copy()))


def check_version(found: str, expected: str) -> None:
    """Refuse to work together with another version of the package."""
    if found != expected:
        raise InputError(
            f"--scheduler: a worker has uvshear {found}, but this machine has {expected}; both must be the same"
        )


def unpacked(sent: Parcel | bytes) -> Any:
    """Unpack what was sent to this worker.

    Raises
    ------
    InputError
        A module that it needs is not installed here.
    """
    try:
        return (Parcel(sent, ()) if isinstance(sent, bytes) else sent).content()
    except ImportError as error:
        raise InputError(
            f"--scheduler: a worker cannot import what it needs ({error}); it must be installed on the workers as well"
        ) from error


@cache
def _prepare() -> None:
    """Let libraries of this process start no threads, in this call and later: each task has one core."""
    start_libraries_with_one_thread()
    limit_libraries()
