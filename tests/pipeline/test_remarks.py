"""Checks that fail."""

import pytest

from uvshear.errors import InputError
from uvshear.pipeline.remarks import remarks


def test_the_lines_of_a_check_are_returned() -> None:
    assert remarks("the noise", lambda: ["one", "two"]) == ("one", "two")


@pytest.mark.parametrize("error", [ValueError("a\nb"), InputError("a b"), MemoryError("a b")])
def test_a_check_that_fails_is_told_in_one_line(error: Exception) -> None:
    def check() -> list[str]:
        raise error

    (line,) = remarks("the noise", check)
    assert line.startswith(f"the noise could not be checked ({type(error).__name__}: a b)")


def test_an_interruption_is_none_of_its_business() -> None:
    def check() -> list[str]:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        remarks("the noise", check)
