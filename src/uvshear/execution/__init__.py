"""The one place for parallel work: besides the command line, nothing else deals with pools or numbers of threads.

An ``Executor`` runs tasks and gives their results in order. ``Serial``, ``Threads`` and ``Processes`` are executors;
another one needs the methods of ``executor.Executor`` and nothing else. Functions with parallel work take an executor
as an argument, which is ``SERIAL`` unless given.
"""

from uvshear.execution.copied_crew import end_copies
from uvshear.execution.copies import Copies
from uvshear.execution.copying import CAN_COPY, copy_process
from uvshear.execution.cores import available_cores, in_copies, in_processes, in_threads
from uvshear.execution.crew import Crew
from uvshear.execution.executor import Executor
from uvshear.execution.libraries import single_threaded_libraries
from uvshear.execution.processes import Processes, end_processes
from uvshear.execution.resources import Resources
from uvshear.execution.serial import Serial
from uvshear.execution.threads import Threads

SERIAL = Serial()
"""The default executor: one task after the other."""

__all__ = [
    "CAN_COPY",
    "SERIAL",
    "Copies",
    "Crew",
    "Executor",
    "Processes",
    "Resources",
    "Serial",
    "Threads",
    "available_cores",
    "copy_process",
    "end_copies",
    "end_processes",
    "in_copies",
    "in_processes",
    "in_threads",
    "single_threaded_libraries",
]
