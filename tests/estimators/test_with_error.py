"""A number with its standard error, as text."""

import math

import pytest

from uvshear.estimators.with_error import with_error


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.02, 0.012, "+0.02000 +- 0.01200"),
        (-1.2345678e-6, 3.21e-7, "-0.00000123 +- 0.00000032"),
        (1e-5, 9.96e-5, "+0.000010 +- 0.000100"),
        (0.1, 0.0, "+0.10000 +- 0.00000"),
        (0.1, math.nan, "+0.10000 +- nan"),
    ],
)
def test_two_digits_of_the_error_are_shown(value, error, text):
    assert with_error(value, error) == text
