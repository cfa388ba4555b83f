"""Functions of a module that tests hand to executors, processes among them."""

import os
import threading
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


def process(_: object, task: int) -> int:
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
