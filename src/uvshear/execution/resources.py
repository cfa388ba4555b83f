"""Workers and memory that a computation may use."""

import os
from dataclasses import dataclass, field

from uvshear.errors import InputError
from uvshear.execution.cores import in_copies
from uvshear.execution.executor import Executor


def half_of_memory() -> float:
    """Half of the machine's memory [bytes]."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2


@dataclass(frozen=True)
class Resources:
    """Workers and memory that a computation may use.

    Results do not depend on the workers; only averages over cells depend on the memory, if there is little of it.

    Parameters
    ----------
    executor
        Executor of all parallel work; unless given, copies of the process on all cores, or threads where the process
        cannot be copied.
    memory
        Memory for the visibilities and images that are processed at the same time [bytes]; half of the machine's memory
        unless given.
    """

    executor: Executor = field(default_factory=in_copies)
    memory: float = field(default_factory=half_of_memory)

    def __post_init__(self) -> None:
        if not self.memory > 0:
            raise InputError(f"memory of {self.memory:g} bytes; a positive number is needed")
