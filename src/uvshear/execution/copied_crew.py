"""A crew of copies of this process, for work that holds Python's global interpreter lock and reads much memory.

A copy is made by ``fork``: it sees all the memory of this process as it was when it was made, shares it until either
writes to it, and starts within milliseconds. Only tasks, news and results are sent.
"""

import gc
import math
import os
import pickle
import select
import signal
import socket
import struct
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import chain, islice
from operator import length_hint
from typing import Any, Final, NoReturn, Self

from uvshear.execution.copying import copy_process
from uvshear.execution.crew import Crew, Result, Shared, Task

AHEAD: Final = 32
"""Largest number of tasks per worker that are begun or finished while the oldest result has not been yielded."""

MOST_IN_A_BATCH: Final = 8
"""Largest number of tasks in one message."""

WORTH_COPIES: Final = 0.1
"""Work that must have been done or be foreseen before copies are made [s]: as long as it takes to make and end two."""

WORTH_A_MESSAGE: Final = 4e-3
"""Least work that a message should carry [s]. Sending a message takes 0.1 ms, and the smallest tasks take hardly
longer."""

QUEUED: Final = 8
"""Largest number of messages that a copy may have at a time. A copy must not run out of tasks while this process is
busy with one of its own, which may take longer than others."""

SMALL: Final = 2**15
"""Largest message that is sent to a copy that is still working [bytes]. A larger one might not fit into the buffer of
the socket; if the copy's result did not fit either, copy and parent would wait for each other for ever."""

_LENGTH: Final = struct.Struct("=q")

_copies: set[int] = set()
"""Process ids of the copies that have not ended yet."""

_last_duration: dict[Callable[..., Any], float] = {}
"""Duration of the last call of each function in this process [s]."""


@dataclass
class _Copy:
    """A copy, as its parent sees it.

    Parameters
    ----------
    pid
        Process id.
    channel
        Socket that is connected with the copy.
    updates
        Packed updates that the copy gets with its next message.
    begun
        Numbers of the tasks of each message that the copy has not answered yet.
    """

    pid: int
    channel: socket.socket
    updates: list[bytes] = field(default_factory=list)
    begun: deque[list[int]] = field(default_factory=deque)


class CopiedCrew(Crew[Shared]):
    """A crew of this process and its copies, which hold an object.

    The process itself works as well. Three workers, for example, are this process and two copies.

    Parameters
    ----------
    shared
        The object that the tasks use. A copy has it as it was when the copy was made. Of later changes it sees those of
        arrays in shared memory (``shared_memory``) and those that :meth:`tell` passes on.
    workers
        Number of workers, of which one is this process.
    """

    def __init__(self, shared: Shared, workers: int) -> None:
        self._shared, self._workers = shared, workers
        self._copies: list[_Copy] = []
        self._worked = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._end_copies()

    def map(
        self, function: Callable[[Shared, Task], Result], tasks: Iterable[Task]
    ) -> Iterator[Result]:
        """Yield the results; ``AHEAD`` tasks for each worker are begun before them, at most."""
        waiting, left = iter(tasks), length_hint(tasks, 1)
        for number, task in enumerate(waiting):
            # The first call of a function is made in this process: copies made later inherit the code that it compiles.
            if function in _last_duration and self._is_for_copies(function, left - number):
                if not self._copies:
                    self._start()
                yield from self._results(function, enumerate(chain([task], waiting)))
                return
            start = time.perf_counter()
            result = function(self._shared, task)
            _last_duration[function] = time.perf_counter() - start
            self._worked += _last_duration[function]
            yield result

    def tell(self, change: Callable[..., None], *news: Any) -> None:
        """Call ``change(shared, *news)`` in every copy before its next task."""
        if self._copies:
            packed = _packed((change, news))
            for copy in self._copies:
                copy.updates.append(packed)

    def _start(self) -> None:
        for _ in range(self._workers - 1):
            ours, theirs = socket.socketpair()
            pid = copy_process()
            if pid == 0:
                ours.close()
                _serve(self._shared, theirs)
            theirs.close()
            _copies.add(pid)
            self._copies.append(_Copy(pid, ours))
        # The collector of garbage would write into all objects, and their memory would no longer be shared.
        gc.freeze()

    def _end_copies(self) -> None:
        if self._copies:
            gc.unfreeze()
        for copy in self._copies:
            copy.channel.close()
            _end(copy.pid)
        self._copies.clear()

    def _results(
        self, function: Callable[..., Any], waiting: Iterator[tuple[int, Any]]
    ) -> Iterator[Any]:
        try:
            yield from self._results_in_order(function, waiting)
        finally:
            # Answers that nobody has waited for would be taken for those of later tasks.
            if any(copy.begun for copy in self._copies):
                self._end_copies()

    def _results_in_order(
        self, function: Callable[..., Any], waiting: Iterator[tuple[int, Any]]
    ) -> Iterator[Any]:
        known: dict[int, tuple[bool, Any]] = {}
        wanted, in_hand, each_takes = 0, deque[tuple[int, Any]](), math.inf
        while True:
            unfinished = len(known) + sum(len(m) for copy in self._copies for m in copy.begun)
            in_hand.extend(islice(waiting, AHEAD * self._workers - unfinished - len(in_hand)))
            if not (unfinished or in_hand):
                return
            self._send_tasks(function, in_hand, each_takes)
            if in_hand:
                number, task = in_hand.popleft()
                known[number] = _answer(function, self._shared, task)
            for copy in self._answering(waits=wanted not in known and not in_hand):
                seconds, found = _received(copy.channel)
                each_takes = seconds / len(found)
                known.update(zip(copy.begun.popleft(), found, strict=True))
            while wanted in known:
                is_error, result = known.pop(wanted)
                if is_error:
                    raise result
                yield result
                wanted += 1

    def _send_tasks(
        self, function: Callable[..., Any], in_hand: deque[tuple[int, Any]], each_takes: float
    ) -> None:
        """Send tasks to copies that have few, and leave at least one for this process."""
        while len(in_hand) > 1 and self._copies:
            copy = min(self._copies, key=lambda each: len(each.begun))
            # The last tasks wait for the worker that is free first.
            if len(copy.begun) >= min(max(1, len(in_hand) // (2 * self._workers)), QUEUED):
                return
            count = _batch_size(each_takes, len(in_hand), self._workers)
            packed = _packed((copy.updates, function, [t for _, t in islice(in_hand, count)]))
            if copy.begun and len(packed) > SMALL:
                return
            _send(copy.channel, packed)
            copy.updates = []
            copy.begun.append([in_hand.popleft()[0] for _ in range(count)])

    def _answering(self, *, waits: bool) -> list[_Copy]:
        """Return the copies that have answered; wait for the first answer, if asked to and if there will be one."""
        # Unlike select, it takes file descriptors above 1023.
        answers = select.poll()
        busy = {copy.channel.fileno(): copy for copy in self._copies if copy.begun}
        for descriptor in busy:
            answers.register(descriptor, select.POLLIN)
        if not busy:
            return []
        return [busy[descriptor] for descriptor, _ in answers.poll(None if waits else 0)]

    def _is_for_copies(self, function: Callable[..., Any], left: int) -> bool:
        """Tell whether there are copies, or work for copies: what was done so far, and tasks that are left."""
        expected = self._worked + max(left, 1) * _last_duration[function]
        return bool(self._copies) or expected > WORTH_COPIES


def _batch_size(seconds: float, left: int, workers: int) -> int:
    """Choose the number of tasks in the next message; it shrinks, so that all workers finish at about the same time.

    Parameters
    ----------
    seconds
        Time that each of the last tasks took [s].
    left
        Number of tasks that are left.
    workers
        Number of workers.
    """
    worthwhile = WORTH_A_MESSAGE / max(seconds, 1e-9)
    return max(1, min(int(worthwhile), left // (2 * workers), MOST_IN_A_BATCH))


def end_copies() -> None:
    """End all copies, whatever they do, before this process ends without cleaning up."""
    for pid in tuple(_copies):
        _end(pid)


def _end(pid: int) -> None:
    with suppress(ProcessLookupError, ChildProcessError):
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
    _copies.discard(pid)


def _serve(shared: Any, channel: socket.socket) -> NoReturn:
    """Work until the parent closes the channel, and end this copy."""
    status = 1
    try:
        gc.disable()
        # Ctrl-C and SIGHUP reach all processes of a terminal. The parent answers them, and its end ends its copies.
        for number in (signal.SIGINT, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        while (asked := _received(channel, at_end=None)) is not None:
            updates, function, tasks = asked
            for packed in updates:
                change, what = pickle.loads(packed)
                change(shared, *what)
            start = time.perf_counter()
            answers = [_answer(function, shared, task) for task in tasks]
            _send(channel, _packed((time.perf_counter() - start, answers)))
        status = 0
    finally:
        os._exit(status)


def _answer(function: Callable[..., Any], shared: Any, task: Any) -> tuple[bool, Any]:
    """Return whether a task has failed, and its result or its error."""
    try:
        return False, function(shared, task)
    except Exception as error:
        return True, error


def _packed(content: Any) -> bytes:
    return pickle.dumps(content, pickle.HIGHEST_PROTOCOL)


def _send(channel: socket.socket, packed: bytes) -> None:
    try:
        channel.sendall(_LENGTH.pack(len(packed)) + packed)
    except OSError as error:
        raise BrokenExecutor("a copy of the process ended before its work was done") from error


_NOTHING: Final = object()


def _received(channel: socket.socket, at_end: Any = _NOTHING) -> Any:
    head = _exactly(channel, _LENGTH.size)
    if len(head) == _LENGTH.size:
        length = _LENGTH.unpack(head)[0]
        content = _exactly(channel, length)
        if len(content) == length:
            return pickle.loads(content)
    if at_end is _NOTHING:
        raise BrokenExecutor("a copy of the process ended before its work was done")
    return at_end


def _exactly(channel: socket.socket, length: int) -> bytearray:
    content = bytearray(length)
    view, filled = memoryview(content), 0
    while filled < length:
        try:
            count = channel.recv_into(view[filled:], min(length - filled, 1 << 20))
        except ConnectionError:
            count = 0
        if count == 0:
            return bytearray()
        filled += count
    return content
