"""Copies of this process."""

import os
import sys

import pytest

from uvshear.execution import CAN_COPY, copy_process


def test_processes_are_copied_on_linux_only() -> None:
    assert (sys.platform == "linux") == CAN_COPY


@pytest.mark.skipif(not CAN_COPY, reason="processes are copied on Linux only")
def test_a_copy_has_the_memory_of_its_parent() -> None:
    known = [3]
    known.append(4)
    copy = copy_process()
    if copy == 0:
        os._exit(sum(known))
    assert os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1]) == 7
