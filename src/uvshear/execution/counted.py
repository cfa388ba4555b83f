"""Executors that have a number of workers."""

from dataclasses import dataclass

from uvshear.errors import InputError
from uvshear.execution.executor import Executor


@dataclass(frozen=True)
class Counted(Executor):
    """An executor with ``count`` workers."""

    count: int

    def __post_init__(self) -> None:
        if self.count < 1:
            raise InputError(f"{self.count} workers; one or more are needed")

    @property
    def workers(self) -> int:
        """Number of workers."""
        return self.count

    def at_most(self, workers: int) -> Executor:
        """Return an executor with at most this number of workers, and at least one."""
        return type(self)(max(1, min(self.count, workers)))
