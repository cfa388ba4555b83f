"""Executors by number of workers."""

import pytest

from uvshear.execution import (
    Copies,
    Processes,
    Serial,
    Threads,
    available_cores,
    cores,
    in_copies,
    in_processes,
    in_threads,
)


def test_one_worker_is_serial() -> None:
    assert in_threads(1) == in_processes(1) == in_copies(1) == Serial()


def test_more_workers_are_threads_or_processes() -> None:
    assert in_threads(3) == Threads(3)
    assert in_processes(3) == in_copies(3) == Copies(3)


def test_where_no_process_is_copied_others_do_the_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cores, "CAN_COPY", False)
    assert in_processes(3) == Processes(3)
    assert in_copies(3) == Threads(3)


def test_zero_stands_for_all_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cores, "available_cores", lambda: 5)
    assert in_threads() == Threads(5)
    assert in_processes() == in_copies() == Copies(5)


def test_there_is_a_core() -> None:
    assert available_cores() >= 1
