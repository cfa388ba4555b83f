"""A number with its standard error, as text."""

import math

FEWEST_DECIMALS = 5
MOST_DECIMALS = 15


def with_error(value: float, error: float) -> str:
    """Return "value +- error" with two or more digits of the error, and with 5 to 15 decimals."""
    decimals = FEWEST_DECIMALS
    if 0 < error < math.inf:
        decimals = min(max(decimals, 1 - math.floor(math.log10(error))), MOST_DECIMALS)
    return f"{value:+.{decimals}f} +- {error:.{decimals}f}"
