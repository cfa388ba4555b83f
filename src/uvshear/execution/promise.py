"""Results that tasks leave for later tasks of the same call of an executor."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Generic, TypeVar

Value = TypeVar("Value")


class Promise(Generic[Value]):
    """A value that one task of :meth:`Executor.map` works out and later ones use.

    Executors begin tasks in their order. The earliest task that has not ended therefore never waits, if tasks wait for
    earlier ones only.
    """

    def __init__(self) -> None:
        self._future: Future[Value] = Future()

    def keep(self, work_out: Callable[[], Value]) -> None:
        """Work out the value; an error is raised here and in all tasks that wait for the value."""
        try:
            value = work_out()
        except BaseException as error:
            self._future.set_exception(error)
            raise
        self._future.set_result(value)

    def value(self) -> Value:
        """Return the value, as soon as it is known."""
        return self._future.result()
