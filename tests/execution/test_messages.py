"""Messages between processes."""

import socket
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor
from threading import Thread

import numpy as np
import pytest

from uvshear.execution.messages import packed, received, send


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        yield ours, theirs


def test_messages_arrive_whole_and_in_order(pair) -> None:
    ours, theirs = pair
    contents = [None, "text", np.arange(1_000_000.0), {"a": (1, 2)}]

    def send_all() -> None:
        for content in contents:
            send(ours, packed(content))

    sender = Thread(target=send_all)
    sender.start()
    for expected in contents:
        found = received(theirs)
        if isinstance(expected, np.ndarray):
            np.testing.assert_array_equal(found, expected)
        else:
            assert found == expected
    sender.join()


@pytest.mark.parametrize("sent", [0, 3, 20])
def test_a_process_that_has_ended_is_noticed(pair, sent: int) -> None:
    ours, theirs = pair
    message = (1000).to_bytes(8, "little") + b"x" * 100
    ours.sendall(message[:sent])
    ours.close()
    if sent == 0:
        assert received(theirs, at_end=None) is None
    with pytest.raises(BrokenExecutor, match="ended before its work was done"):
        received(theirs)


def test_nothing_can_be_sent_to_a_process_that_has_ended(pair) -> None:
    ours, theirs = pair
    theirs.close()
    with pytest.raises(BrokenExecutor, match="ended before its work was done"):
        send(ours, packed("anyone?"))
