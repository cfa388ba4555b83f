"""A crew of copies of this process, for work that holds Python's global interpreter lock and reads much memory.

A copy is made by ``fork``: it sees all the memory of this process as it was when it was made, shares it until either
writes to it, and starts within milliseconds. Only tasks, changes and results are sent.
"""

import gc
import math
import os
import pickle
import select
import signal
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import chain, islice
from operator import length_hint
from typing import TYPE_CHECKING, Any, Final, NoReturn, Self, cast

from uvshear.execution.copying import copy_process
from uvshear.execution.crew import Crew, Result, Shared, Task
from uvshear.execution.messages import packed, received, send

if TYPE_CHECKING:
    from uvshear.execution.handing_over import HandedOver

AHEAD: Final = 32
"""Largest number of tasks per worker that are begun or finished while the oldest result has not been yielded."""

MOST_IN_A_BATCH: Final = 8
"""Largest number of tasks in one message."""

WORTH_COPIES: Final = 0.1
"""Work that must have been done or be foreseen before copies are made [s]: as long as it takes to make and end two."""

WORTH_A_MESSAGE: Final = 4e-3
"""Least work that a message should carry [s]. Sending a message takes 0.1 ms, and the smallest tasks take hardly
longer."""

QUEUED: Final = 2
"""Number of messages that a copy may have at a time: one to work on, and the next."""

WAKE: Final = 0.2
"""Longest time in which this process, while it waits for a copy, does not notice an interruption [s]."""

SMALL: Final = 2**15
"""Largest message that is sent to a copy that is still working [bytes]. A larger one might not fit into the buffer of
the socket; if the copy's result did not fit either, copy and parent would wait for each other for ever."""

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


@dataclass
class _Call:
    """Tasks of a call of :meth:`CopiedCrew.map`.

    Parameters
    ----------
    function
        Function of the tasks.
    in_hand
        Tasks that nobody has begun, with their numbers.
    known
        For each task that is finished, whether it has failed, and its result or error.
    seconds
        Duration of a task in the last message [s].
    """

    function: Callable[..., Any]
    in_hand: deque[tuple[int, Any]] = field(default_factory=deque)
    known: dict[int, tuple[bool, Any]] = field(default_factory=dict)
    seconds: float = math.inf


class CopiedCrew(Crew[Shared]):
    """A crew of this process and its copies, which hold an object.

    The process itself works as well. Three workers, for example, are this process and two copies. A thread takes the
    copies' answers and sends them their next tasks while the process is busy with a task of its own.

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
        self._changed = threading.Condition()
        self._call: _Call | None = None
        self._failure: Exception | None = None
        self._listener: threading.Thread | None = None
        self._memory: Any = None

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
            if self._is_for_copies(function, left - number):
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
            message = packed((_change, (change, news)))
            for copy in self._copies:
                copy.updates.append(message)

    def hold(self, shared: Shared) -> None:
        """Let all workers hold another object from now on.

        Copies receive it through the common region (``handing_over``), which must have been reserved before they were
        made. Where that is impossible they are ended; those that are made later know the object.
        """
        self._shared = shared
        if not self._copies:
            return
        from uvshear.execution.handing_over import hand_over  # noqa: PLC0415 - loads NumPy, help does not

        try:
            handed, memory = hand_over(shared)
        except Exception:  # it cannot be pickled, or there is no room for it
            self._end_copies()
            return
        message = packed((_receive, (handed,)))
        for copy in self._copies:
            copy.updates = [message]
        # Copies that have not received the previous object will receive this one.
        self._memory = memory

    def release(self) -> None:
        """Hold no object, until the next call of :meth:`hold`."""
        self._shared, self._memory = cast(Shared, None), None

    @property
    def holds_something(self) -> bool:
        """Whether the workers hold an object."""
        return self._shared is not None

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
        if not self._copies:
            return
        # The collector of garbage would write into all objects, and their memory would no longer be shared.
        gc.freeze()
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()

    def _end_copies(self) -> None:
        _end([copy.pid for copy in self._copies])
        # The listener ends when it finds that a copy has ended.
        if self._listener is not None:
            self._listener.join()
            gc.unfreeze()
        for copy in self._copies:
            copy.channel.close()
        self._copies.clear()
        self._listener, self._failure, self._memory = None, None, None

    def _results(
        self, function: Callable[..., Any], waiting: Iterator[tuple[int, Any]]
    ) -> Iterator[Any]:
        call = self._call = _Call(function)
        try:
            yield from self._results_in_order(call, waiting)
        finally:
            with self._changed:
                self._call = None
                was_given_up = any(copy.begun for copy in self._copies)
            # Answers that nobody has waited for would be taken for those of later tasks.
            if was_given_up:
                self._end_copies()

    def _results_in_order(self, call: _Call, waiting: Iterator[tuple[int, Any]]) -> Iterator[Any]:
        wanted = 0
        while True:
            with self._changed:
                room = AHEAD * self._workers - self._unfinished(call) - len(call.in_hand)
            fresh = list(islice(waiting, room))
            with self._changed:
                call.in_hand.extend(fresh)
                if not (self._unfinished(call) or call.in_hand):
                    return
                self._send_tasks(call, kept=1)
                own = call.in_hand.popleft() if call.in_hand else None
                while own is None and wanted not in call.known and self._failure is None:
                    self._changed.wait(WAKE)
                if self._failure is not None:
                    raise self._failure
            if own is not None:
                self._work(call, *own)
            while wanted in call.known:
                is_error, result = call.known.pop(wanted)
                if is_error:
                    raise result
                yield result
                wanted += 1

    def _work(self, call: _Call, number: int, task: Any) -> None:
        start = time.perf_counter()
        call.known[number] = _answer(call.function, self._shared, task)
        _last_duration[call.function] = time.perf_counter() - start

    def _unfinished(self, call: _Call) -> int:
        """Count the tasks that have been begun and whose results have not been yielded."""
        return len(call.known) + sum(len(each) for copy in self._copies for each in copy.begun)

    def _send_tasks(self, call: _Call, kept: int = 0) -> None:
        """Send tasks to copies that have few; some are kept for this process."""
        while len(call.in_hand) > kept and self._copies:
            copy = min(self._copies, key=lambda each: len(each.begun))
            # The last tasks wait for the worker that is free first.
            if len(copy.begun) >= (QUEUED if len(call.in_hand) > self._workers else 1):
                return
            count = _batch_size(call.seconds, len(call.in_hand), self._workers)
            tasks = [task for _, task in islice(call.in_hand, count)]
            message = packed((copy.updates, call.function, tasks))
            if copy.begun and len(message) > SMALL:
                return
            send(copy.channel, message)
            copy.updates = []
            copy.begun.append([call.in_hand.popleft()[0] for _ in range(count)])

    def _listen(self) -> None:
        """Take answers and send further tasks until a copy ends."""
        # Unlike select, it takes file descriptors above 1023.
        answers = select.poll()
        copies = {copy.channel.fileno(): copy for copy in self._copies}
        for descriptor in copies:
            answers.register(descriptor, select.POLLIN)
        while True:
            for descriptor, _ in answers.poll():
                copy = copies[descriptor]
                try:
                    seconds, found = received(copy.channel)
                    with self._changed:
                        self._take(copy, seconds, found)
                except Exception as error:
                    with self._changed:
                        self._failure = error
                        self._changed.notify()
                    return

    def _take(self, copy: _Copy, seconds: float, found: Sequence[tuple[bool, Any]]) -> None:
        numbers, call = copy.begun.popleft(), self._call
        if call is None:
            return  # of a call that was given up
        call.known.update(zip(numbers, found, strict=True))
        call.seconds = seconds / len(found)
        self._send_tasks(call)
        self._changed.notify()

    def _is_for_copies(self, function: Callable[..., Any], left: int) -> bool:
        """Tell whether there are copies, or work for copies: what was done so far, and tasks that are left."""
        if self._copies:
            return True
        if (seconds := _last_duration.get(function)) is None:
            # It may take minutes.
            return left > 1
        return self._worked + max(left, 1) * seconds > WORTH_COPIES


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


def copies_at_work() -> tuple[int, ...]:
    """Return the process ids of the copies that have not ended yet."""
    return tuple(_copies)


def end_copies() -> None:
    """End all copies, whatever they do, before this process ends without cleaning up."""
    _end(tuple(_copies))


def _end(pids: Sequence[int]) -> None:
    # All of them are killed before any is waited for: the system needs 10 ms to take one down.
    for pid in pids:
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    for pid in pids:
        with suppress(ChildProcessError):
            os.waitpid(pid, 0)
        _copies.discard(pid)


def _serve(shared: Any, channel: socket.socket) -> NoReturn:
    """Work until the parent closes the channel, and end this copy."""
    status = 1
    try:
        # The collector of garbage would write into all objects, and their memory would no longer be shared.
        gc.freeze()
        # Ctrl-C and SIGHUP reach all processes of a terminal. The parent answers them, and its end ends its copies.
        for number in (signal.SIGINT, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        while (asked := received(channel, at_end=None)) is not None:
            updates, function, tasks = asked
            for message in updates:
                update, news = pickle.loads(message)
                shared = update(shared, *news)
            start = time.perf_counter()
            answers = [_answer(function, shared, task) for task in tasks]
            send(channel, packed((time.perf_counter() - start, answers)))
        status = 0
    finally:
        os._exit(status)


def _change(shared: Any, change: Callable[..., None], news: Sequence[Any]) -> Any:
    change(shared, *news)
    return shared


def _receive(_: Any, handed: "HandedOver") -> Any:
    return handed.received()


def _answer(function: Callable[..., Any], shared: Any, task: Any) -> tuple[bool, Any]:
    """Return whether a task has failed, and its result or its error."""
    try:
        return False, function(shared, task)
    except Exception as error:
        return True, error
