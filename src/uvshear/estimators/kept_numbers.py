"""Checks of numbers that were kept in a file, which may have been damaged or changed since."""

from collections.abc import Iterable
from typing import Final

import numpy as np

from uvshear.errors import InputError
from uvshear.estimators.sample import Sample
from uvshear.typing import Array, Bool, Float

LARGEST: Final = 1e30
"""Modulus below which every number of an estimator is, in SI; sums of products of larger ones may overflow."""


def incomplete(
    sample: Sample, names: Iterable[str], positive: Iterable[str] = ()
) -> Bool[Array, " source"]:
    """Tell which sources have numbers that cannot have been kept together.

    An estimator keeps all of its numbers or none of them, which is NaN in each column.

    Parameters
    ----------
    names
        Columns of the numbers.
    positive
        Columns among these that are variances.
    """
    numbers = np.stack([_plain(sample, name) for name in names], axis=-1)
    is_number = np.abs(numbers) < LARGEST
    found: Bool[Array, " source"] = ~(is_number.all(axis=1) | np.isnan(numbers).all(axis=1))
    for name in positive:
        found |= sample[name] < 0
    return found


def _plain(sample: Sample, name: str) -> Float[Array, " source"]:
    """Return a column with one number for each source."""
    try:
        numbers = np.asarray(sample[name], float)
    except (TypeError, ValueError):
        numbers = np.empty((0, 0))
    if numbers.ndim != 1:
        raise InputError(
            f"the statistics are damaged: column '{name}' has other values than one number for each source; measure"
            " again"
        )
    return numbers
