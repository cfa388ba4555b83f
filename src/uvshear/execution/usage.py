"""CPU time and memory of this process and of its worker processes."""

import os
import resource
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from uvshear.execution.copied_crew import copies_at_work

_TICKS: Final = os.sysconf("SC_CLK_TCK")
_MAXRSS: Final = 1 if sys.platform == "darwin" else 1024
"""Unit of the largest memory that the system reports [bytes]."""


@dataclass(frozen=True)
class Usage:
    """What this process and its worker processes have used.

    Parameters
    ----------
    cpu_seconds
        CPU time so far [s].
    memory
        Resident memory at present [bytes]. Pages that copies share with this process count once.
    peak
        Largest resident memory that this process alone has had so far [bytes].
    """

    cpu_seconds: float
    memory: float
    peak: float

    @classmethod
    def now(cls) -> "Usage":
        """Return the present usage. Where the system does not tell, numbers are those of this process and its peak."""
        workers = tuple(_workers())
        own, ended = (
            resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        )
        seconds = own.ru_utime + own.ru_stime + ended.ru_utime + ended.ru_stime
        peak = own.ru_maxrss * _MAXRSS
        return cls(
            cpu_seconds=seconds + sum(map(_cpu_seconds, workers)),
            memory=(_resident() or peak) + sum(map(_private, workers)),
            peak=peak,
        )


def _workers() -> Iterable[int]:
    """Yield the process ids of copies and of other processes that have not ended."""
    yield from copies_at_work()
    if (multiprocessing := sys.modules.get("multiprocessing")) is not None:
        yield from (child.pid for child in multiprocessing.active_children() if child.pid)


def _cpu_seconds(pid: int) -> float:
    """CPU time that another process has used [s]; 0 if it has ended."""
    try:
        # The name of the program, which comes before, may contain spaces.
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / _TICKS
    except (OSError, IndexError, ValueError):
        return 0.0


def _private(pid: int) -> float:
    """Memory that another process shares with none [bytes]; 0 if it has ended."""
    try:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="utf-8").splitlines()
        return 1024 * sum(int(line.split()[1]) for line in lines if line.startswith("Private_"))
    except (OSError, IndexError, ValueError):
        return 0.0


def _resident() -> float:
    """Resident memory of this process [bytes]; 0 if the system does not tell."""
    try:
        return int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1]) * os.sysconf(
            "SC_PAGE_SIZE"
        )
    except (OSError, IndexError, ValueError):
        return 0.0
