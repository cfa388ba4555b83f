"""Functions of a module that tests hand to executors, processes among them."""

import os
import threading
import time
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_info


def affine(shared: int, task: int) -> int:
    return shared * task + 1


def inverse(shared: int, task: int) -> int:
    return shared // task


def own_sum(shared: np.ndarray, task: int) -> float:
    """A sum whose last bits depend on its order."""
    return float(np.sum(np.sin(shared * task)))


def read(task: int) -> np.ndarray:
    """Stand for the data of a partition."""
    return np.arange(task, task + 3.0)


def waves_of_data(shared: np.ndarray, task: int, data: np.ndarray) -> np.ndarray:
    """Do the same as ``waves``, and check the data."""
    np.testing.assert_array_equal(data, read(task))
    return waves(shared, task)


def failing_of_data(shared: None, task: int, data: np.ndarray) -> float:
    """Do the same as ``failing``."""
    return failing(shared, int(data[0]))


def waves(shared: np.ndarray, task: int) -> np.ndarray:
    return np.sin(shared * (task + 1))


def slow_waves(shared: np.ndarray, task: int) -> np.ndarray:
    time.sleep(0.05)
    return waves(shared, task)


def added(total: np.ndarray, more: np.ndarray) -> np.ndarray:
    """Add in place, as sums of large arrays are added."""
    total += more
    return total


def process(_: object, task: int) -> int:
    return os.getpid()


def brief(_: object, task: int) -> tuple[int, int]:
    time.sleep(0.01)
    return task, os.getpid()


def long_in(parent: int, task: int) -> int:
    """Take long in one process, and hardly any time in others; return the number of the process."""
    time.sleep(0.5 if os.getpid() == parent else 0.01)
    return os.getpid()


def library_threads(_: object, task: int) -> int:
    np.ones((2, 2)) @ np.ones((2, 2))
    return max((pool["num_threads"] for pool in threadpool_info()), default=1)


class CountsItsPickles:
    """Writes a line to a file whenever it is sent to another process."""

    def __init__(self, log: Path) -> None:
        self.log = log

    def __getstate__(self) -> dict[str, object]:
        with self.log.open("a", encoding="utf-8") as file:
            file.write("sent\n")
        return self.__dict__


def nothing(shared: CountsItsPickles, task: int) -> int:
    return task


class Meeting:
    """A task that ends when two of them run at the same time, and fails otherwise."""

    def __init__(self) -> None:
        self.barrier = threading.Barrier(2, timeout=5)

    def __call__(self, task: int) -> int:
        return self.barrier.wait()


class Ledger:
    """An object that a crew shares: a number that it is told, and memory that its copies see."""

    def __init__(self, memory: np.ndarray) -> None:
        self.memory, self.number = memory, 0

    def adopt(self, number: int) -> None:
        self.number = number


def entry(ledger: Ledger, task: int) -> tuple[int, float, int]:
    return ledger.number, float(ledger.memory[0]), task


def seen_by(ledger: Ledger, task: int) -> tuple[int, float, int]:
    """Return what the process that does the task sees, and the number of this process."""
    time.sleep(1e-3)
    return ledger.number, float(ledger.memory[0]), os.getpid()


def failing(_: object, task: int) -> int:
    if task == 3:
        raise ValueError(f"task {task}")
    return task


def ended(parent: int, task: int) -> int:
    """Ends the process in which it runs, unless this is the parent."""
    time.sleep(0.01)
    if os.getpid() != parent:
        os.kill(os.getpid(), 9)
    return task


def slow_first(_: object, task: int) -> int:
    time.sleep(0.3 if task == 1 else 0.0)
    return task


def large(_: object, task: int) -> np.ndarray:
    return np.full(1_000_000, task)


def children() -> set[int]:
    """Return the numbers of the processes that this one has started and that have not been waited for."""
    found: set[int] = set()
    for listed in Path(f"/proc/{os.getpid()}/task").glob("*/children"):
        found |= set(map(int, listed.read_text().split()))
    return found


def number_of(shared, task: int) -> tuple[int, int]:
    time.sleep(0.01)
    return shared.number, os.getpid()
