"""Whether a mutated table is as good as the clean one: some of its numbers have become others that could be."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from astropy.table import Table

from tests.fuzz.tables import read
from tests.fuzz.wild import numbers_differ

Ranges = Mapping[str, tuple[float, float]]
"""Smallest and largest number of each column that may differ."""


def is_another_valid_table(
    path: Path, clean: Path, ranges: Ranges, optional: frozenset[str] = frozenset()
) -> bool:
    """Tell whether a table differs from the clean one only by numbers within their ranges, or by a source fewer.

    Parameters
    ----------
    ranges
        Columns of numbers that may differ.
    optional
        Columns that may be there or not.
    """
    try:
        new, old = read(path), read(clean)
    except Exception:  # astropy's readers raise what they like
        return False
    if len(new) > len(old):
        return False
    for name in set(old.colnames) | set(new.colnames):
        if name in optional and (name in new.colnames) != (name in old.colnames):
            continue
        if name not in new.colnames:
            if name in ranges:
                return False
            continue
        if name in ranges and not _is_possible(new, old, name, ranges[name]):
            return False
    return True


def _is_possible(new: Table, old: Table, name: str, limits: tuple[float, float]) -> bool:
    if name not in old.colnames or new[name].unit != old[name].unit:
        return False
    values = np.ma.filled(np.ma.asarray(new[name], dtype=float), np.nan)
    return values.ndim == 1 and bool(np.all((values >= limits[0]) & (values <= limits[1])))


def where_text_differs(new: bytes, old: bytes, allowed: Callable[[str], bool]) -> bool:
    """Tell whether two texts of the same length differ only where all the new characters are allowed."""
    if len(new) != len(old):
        return False
    pairs = zip(new, old, strict=True)
    return all(allowed(chr(one)) and allowed(chr(other)) for one, other in pairs if one != other)


__all__ = ["is_another_valid_table", "numbers_differ", "where_text_differs"]
