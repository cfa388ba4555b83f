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
from typing import Any, Final, NoReturn, Self

from uvshear.execution.copying import copy_process
from uvshear.execution.crew import Crew, Result, Shared, Task

AHEAD: Final = 16
"""Number of tasks for each copy that are begun before the result of the first of them is taken, at most."""

TOGETHER: Final = 8
"""Largest number of tasks in one message."""

WORTH_COPIES: Final = 0.1
"""Work that this process does before it makes copies [s]: to make and to end two of them takes as long."""

WORTH_A_MESSAGE: Final = 8e-3
"""Work that is enough for one message [s]: a message costs a tenth of a millisecond, and the smallest tasks little
more."""

QUEUED: Final = 2
"""Number of messages that a copy has at the same time, so that it need not wait for this process between two of
them."""

SMALL: Final = 2**15
"""Size of a message that a copy may have besides another [bytes]. A larger one would not fit into the buffer of its
channel: copy and parent would wait for each other for ever if a result was as large."""

_LENGTH: Final = struct.Struct("=q")

_copies: set[int] = set()
"""Copies that have not ended yet."""

_seconds: dict[Callable[..., Any], float] = {}
"""Functions that this process has called, and how long the last call took [s]."""


@dataclass
class _Copy:
    """A copy, as its parent sees it."""

    pid: int
    channel: socket.socket
    news: list[bytes] = field(default_factory=list)


class CopiedCrew(Crew[Shared]):
    """Copies of this process that hold copies of an object.

    Parameters
    ----------
    shared
        The object, of which copies see every later change of memory that processes share, and all that they are told.
    workers
        Number of copies.
    """

    def __init__(self, shared: Shared, workers: int) -> None:
        self._shared, self._workers = shared, workers
        self._copies: list[_Copy] = []
        self._worked = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for copy in self._copies:
            copy.channel.close()
            _end(copy.pid)
        self._copies.clear()

    def map(
        self, function: Callable[[Shared, Task], Result], tasks: Iterable[Task]
    ) -> Iterator[Result]:
        """Yield the results; ``AHEAD`` tasks for each copy are begun before them, at most."""
        waiting = iter(tasks)
        for task in waiting:
            # What a new function compiles, copies that are made after its first call have from the start.
            if function in _seconds and (self._copies or self._is_worth_copies(function)):
                if not self._copies:
                    self._start()
                yield from self._results(function, enumerate(chain([task], waiting)))
                return
            start = time.perf_counter()
            result = function(self._shared, task)
            _seconds[function] = time.perf_counter() - start
            self._worked += _seconds[function]
            yield result

    def tell(self, change: Callable[..., None], *news: Any) -> None:
        """Call ``change(shared, *news)`` in every copy before its next task."""
        if self._copies:
            packed = _packed((change, news))
            for copy in self._copies:
                copy.news.append(packed)

    def _start(self) -> None:
        gc.freeze()
        try:
            for _ in range(self._workers):
                ours, theirs = socket.socketpair()
                pid = copy_process()
                if pid == 0:
                    ours.close()
                    _serve(self._shared, theirs)
                theirs.close()
                _copies.add(pid)
                self._copies.append(_Copy(pid, ours))
        finally:
            gc.unfreeze()

    def _results(
        self, function: Callable[..., Any], waiting: Iterator[tuple[int, Any]]
    ) -> Iterator[Any]:
        # Unlike select, it takes file descriptors above 1023.
        answers = select.poll()
        copies = {copy.channel.fileno(): copy for copy in self._copies}
        begun: dict[int, deque[list[int]]] = {descriptor: deque() for descriptor in copies}
        known: dict[int, tuple[bool, Any]] = {}
        wanted, in_hand, each_takes = 0, deque[tuple[int, Any]](), math.inf
        while True:
            unfinished = len(known) + sum(len(each) for queue in begun.values() for each in queue)
            in_hand.extend(islice(waiting, AHEAD * self._workers - unfinished - len(in_hand)))
            if not (unfinished or in_hand):
                return
            while in_hand:
                descriptor = min(begun, key=lambda each: len(begun[each]))
                # The last tasks wait for the copy that is free first.
                if len(begun[descriptor]) >= (QUEUED if len(in_hand) > self._workers else 1):
                    break
                count = _together(each_takes, len(in_hand), self._workers)
                copy = copies[descriptor]
                packed = _packed((copy.news, function, [t for _, t in islice(in_hand, count)]))
                if begun[descriptor] and len(packed) > SMALL:
                    break
                _send(copy.channel, packed)
                copy.news = []
                if not begun[descriptor]:
                    answers.register(descriptor, select.POLLIN)
                begun[descriptor].append([in_hand.popleft()[0] for _ in range(count)])
            while wanted in known:
                is_error, found = known.pop(wanted)
                if is_error:
                    raise found
                yield found
                wanted += 1
            if not any(begun.values()):
                continue
            for descriptor, _ in answers.poll():
                seconds, found_now = _received(copies[descriptor].channel)
                each_takes = seconds / len(found_now)
                known.update(zip(begun[descriptor].popleft(), found_now, strict=True))
                if not begun[descriptor]:
                    answers.unregister(descriptor)

    def _is_worth_copies(self, function: Callable[..., Any]) -> bool:
        """Tell whether this process alone would work longer than it takes to make copies."""
        return self._worked + _seconds[function] > WORTH_COPIES


def _together(seconds: float, left: int, workers: int) -> int:
    """Choose the number of tasks of the next message: fewer and fewer, so that all copies end at the same time.

    Parameters
    ----------
    seconds
        Time that each of the last tasks took [s].
    left
        Number of tasks that are left.
    workers
        Number of copies.
    """
    worthwhile = WORTH_A_MESSAGE / max(seconds, 1e-9)
    return max(1, min(int(worthwhile), left // (2 * workers), TOGETHER))


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
        # The parent answers the signals of a terminal; whatever ends it, ends its copies.
        for number in (signal.SIGINT, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        while (asked := _received(channel, at_end=None)) is not None:
            news, function, tasks = asked
            for packed in news:
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
