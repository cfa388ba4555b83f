"""A number with its standard error, as text."""

import math

FEWEST_DECIMALS = 5


def with_error(value: float, error: float) -> str:
    """Return "value +- error" with two or more digits of the error, and with five decimals or more."""
    decimals = FEWEST_DECIMALS
    if 0 < error < math.inf:
        decimals = max(decimals, 1 - math.floor(math.log10(error)))
    return f"{value:+.{decimals}f} +- {error:.{decimals}f}"
