"""Parallel work. Besides the command line, no other package deals with pools or numbers of threads.

An ``Executor`` runs tasks and returns their results in order. ``Serial``, ``Threads``, ``Processes``, ``Copies``
(forked processes) and ``Dask`` (a cluster) are executors; others are subclasses of ``Executor``. Functions with
parallel work take an executor as an argument; the default is ``SERIAL``. Nothing of Dask itself is imported before a
cluster is used.
"""

from uvshear.execution.copied_crew import end_copies
from uvshear.execution.copies import Copies
from uvshear.execution.copying import CAN_COPY, copy_process
from uvshear.execution.cores import available_cores, in_copies, in_processes, in_threads
from uvshear.execution.crew import Crew
from uvshear.execution.dask_connection import connected
from uvshear.execution.dask_errors import ClusterLost
from uvshear.execution.dask_executor import Dask
from uvshear.execution.executor import Executor
from uvshear.execution.free_memory import give_back_free_memory
from uvshear.execution.libraries import single_threaded_libraries, start_libraries_with_one_thread
from uvshear.execution.processes import Processes, end_processes
from uvshear.execution.promise import Promise
from uvshear.execution.resources import Resources
from uvshear.execution.serial import Serial
from uvshear.execution.threads import Threads
from uvshear.execution.used_value import UsedValue

SERIAL = Serial()
"""The default executor: one task after the other."""

__all__ = [
    "CAN_COPY",
    "SERIAL",
    "ClusterLost",
    "Copies",
    "Crew",
    "Dask",
    "Executor",
    "Processes",
    "Promise",
    "Resources",
    "Serial",
    "Threads",
    "UsedValue",
    "available_cores",
    "connected",
    "copy_process",
    "end_copies",
    "end_processes",
    "give_back_free_memory",
    "in_copies",
    "in_processes",
    "in_threads",
    "single_threaded_libraries",
    "start_libraries_with_one_thread",
]
