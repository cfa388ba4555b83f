"""Whether a mutated Measurement Set is as good as the clean one: all that has changed could have been observed.

The sets are compared with casacore alone. The rules are narrow: whatever has changed otherwise must be told.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
from casacore import tables

from tests.fuzz.wild import numbers_differ

FEW: Final = 8
"""Largest number of rows in which visibilities, weights, or baselines may differ unnoticed."""

Rule = Callable[[Any, Any], Any]


def _as_any(new: Any, old: Any) -> Any:
    """Accept any value."""
    return np.ones(np.shape(new), bool)


def _as_none(new: Any, old: Any) -> Any:
    """Accept no other value."""
    return np.zeros(np.shape(new), bool)


def _within_range(new: Any, old: Any) -> Any:
    """Accept visibilities not much larger than the largest one that is there."""
    return np.isfinite(new) & (np.abs(new) <= 3 * np.abs(old).max())


def _of_the_same_order(new: Any, old: Any) -> Any:
    """Accept weights that are not much larger; one without weight is as good as flagged."""
    return (new >= 0) & (new <= 10 * old)


def _of_averages(new: Any, old: Any) -> Any:
    """Accept numbers of averages no larger than the largest one that is there, and some that are a little larger."""
    return np.isfinite(new) & (np.abs(new) <= 30 * np.abs(old).max())


def _of_the_sub_band(new: Any, old: Any) -> Any:
    """Accept frequencies near the old ones."""
    return (new > 0.75 * old) & (new < 1.35 * old)


def _of_a_channel(new: Any, old: Any) -> Any:
    """Accept widths of less than a gigahertz."""
    return (new >= 0) & (new < 1e9)


def _of_stokes_i(weights: Any) -> Any:
    """Return the weight of the mean of all hands: one that is far too large in one hand alone only doubles it."""
    with np.errstate(all="ignore"):
        combined = np.where((weights > 0).all(axis=-1), 1 / np.sum(1 / weights, axis=-1), 0)
    return np.where(np.isfinite(weights).all(axis=-1), combined, 0)


def _between_the_antennas(new: Any, old: Any) -> Any:
    """Accept baselines that are as long as the old ones, but for two per cent and the diameter of a dish."""
    length, before = (np.linalg.norm(one, axis=-1, keepdims=True) for one in (new, old))
    is_alike = np.abs(length - before) <= 0.02 * before + 25.0
    return (length > 0) & is_alike & np.ones(np.shape(new), bool)


def _is_rounding(new: Any, old: Any) -> bool:
    """Tell whether baselines are no further off than those of an array that moves by 1e-3 of its size."""
    return bool(np.abs(new - old).max() <= 1e-3 * np.linalg.norm(old, axis=-1).max())


OF_ROWS: Final[dict[str, Rule]] = {
    "DATA": _within_range,
    "UVSHEAR_FREQUENCY": _of_the_sub_band,
    "UVSHEAR_WIDTH": _of_a_channel,
    "UVSHEAR_SECOND": _of_averages,
    "UVSHEAR_FOURTH": _of_averages,
    "WEIGHT_SPECTRUM": _of_the_same_order,
    "UVW": _between_the_antennas,
    "FLAG": _as_any,
    "FLAG_ROW": _as_any,
    "DATA_DESC_ID": _as_none,
    "FIELD_ID": _as_none,
}
"""Rules for single rows: of all rows, or of a part of a column, they would be told apart from what was observed."""

WEIGHTS: Final = ("WEIGHT_SPECTRUM", "WEIGHT")
"""Columns of weights; the second counts where the first is not there."""

OF_ANY_ROWS: Final = ("FLAG", "FLAG_ROW", "UVSHEAR_FOURTH")
"""Columns of which all rows may differ unnoticed."""

UNCHANGED: Final = {
    "FIELD": ("PHASE_DIR",),
    "SPECTRAL_WINDOW": ("CHAN_FREQ", "CHAN_WIDTH"),
    "POLARIZATION": ("CORR_TYPE",),
    "DATA_DESCRIPTION": ("SPECTRAL_WINDOW_ID", "POLARIZATION_ID"),
}
"""Columns on which shapes depend."""

ROUNDING: Final = 1e-6
"""Difference of phase centres that no check can tell, 0.2 arcsec [rad]."""

COPIED: Final = (
    "DATA",
    *WEIGHTS,
    "UVW",
    "FLAG",
    "FLAG_ROW",
    "DATA_DESC_ID",
    "FIELD_ID",
    "TIME",
    *("UVSHEAR_FREQUENCY", "UVSHEAR_WIDTH", "UVSHEAR_SECOND", "UVSHEAR_FOURTH"),
)
"""Columns that rows keep when others are removed, as far as a set has them."""


def is_another_valid_set(path: Path, clean: Path) -> bool:
    """Tell whether all that differs could have been observed."""
    if not _are_described_alike(path, clean):
        return False
    if _is_selection(path, clean):
        return True
    return (
        _is_within_interval(path)
        and _are_same_baselines(path, clean)
        and all(_is_another_valid_column(path, clean, name) for name in OF_ROWS)
        and (_has_spectra(path) or _is_another_valid_column(path, clean, "WEIGHT"))
    )


def _are_described_alike(path: Path, clean: Path) -> bool:
    """Tell whether the subtables are the same, but for what the data cannot show."""
    for table, columns in UNCHANGED.items():
        for column in columns:
            new, old = _cells(path / table, column), _cells(clean / table, column)
            if not _are_equal(new, old, ROUNDING if column == "PHASE_DIR" else 0.0):
                return False
    windows = path / "SPECTRAL_WINDOW"
    effective, width = (_cells(windows, name) for name in ("EFFECTIVE_BW", "CHAN_WIDTH"))
    before = _cells(clean / "SPECTRAL_WINDOW", "EFFECTIVE_BW")
    return _are_equal(effective, before) or _are_within(effective, width, before)


def _are_within(
    effective: list[Any] | None, width: list[Any] | None, before: list[Any] | None
) -> bool:
    """Tell whether channels that were averages are averages over about their width."""
    if effective is None or width is None or before is None or len(effective) != len(before):
        return False
    return all(
        np.shape(new) == np.shape(old)
        and bool(np.all((new >= 0.5 * np.abs(most)) & (new <= 4 * np.abs(most)) & (old > 0)))
        for new, most, old in zip(effective, width, before, strict=True)
    )


def _is_another_valid_column(path: Path, clean: Path, column: str) -> bool:
    if _cells(clean, column) is None:
        return _cells(path, column) is None
    new, old = (_stacked(one, column) for one in (path, clean))
    if new is None or old is None or new.shape != old.shape:
        return False
    if column in WEIGHTS:
        new, old = _of_stokes_i(new), _of_stokes_i(old)
    differs = numbers_differ(new, old)
    if column in WEIGHTS:
        # By weights that are off by less than a factor of two, shapes change by less than noise.
        differs &= (new < old / 2) | (new > 2.001 * old)
    if column == "UVW" and _is_rounding(new, old):
        return True
    rule = OF_ROWS.get(column, _of_the_same_order)
    rows = differs.reshape(len(new), -1).any(axis=1)
    is_few = column in OF_ANY_ROWS or np.count_nonzero(rows) <= FEW
    return bool(is_few and rule(new, old)[differs].all())


def _has_spectra(path: Path) -> bool:
    return _cells(path, WEIGHTS[0]) is not None


def _is_within_interval(path: Path) -> bool:
    """Tell whether all samples are averages over less than their integration, as some are whose data are flagged."""
    exposure, interval = (_stacked(path, name) for name in ("EXPOSURE", "INTERVAL"))
    if exposure is None or interval is None:
        return False
    return bool(np.all((exposure >= 0) & (exposure <= 1.01 * interval)))


def _are_same_baselines(path: Path, clean: Path) -> bool:
    """Tell whether the same rows are of two antennas; without a primary beam, it does not matter of which."""
    new, old = ([_stacked(one, f"ANTENNA{end}") for end in (1, 2)] for one in (path, clean))
    if any(end is None for end in new) or np.shape(new) != np.shape(old):
        return False
    return bool(np.all((new[0] == new[1]) == (old[0] == old[1])))


def _cells(path: Path, column: str) -> list[Any] | None:
    with tables.table(str(path), ack=False) as table:
        if column not in table.colnames():
            return None
        return [table.getcell(column, row) for row in range(table.nrows())]


def _are_equal(new: list[Any] | None, old: list[Any] | None, within: float = 0.0) -> bool:
    if new is None or old is None or len(new) != len(old):
        return new is old
    return all(
        np.array_equal(one, other)
        or (np.shape(one) == np.shape(other) and np.max(np.abs(one - other)) <= within)
        for one, other in zip(new, old, strict=True)
    )


def _is_selection(path: Path, clean: Path) -> bool:
    """Tell whether rows were removed, and all others are as they were."""
    names = [name for name in COPIED if _cells(clean, name) is not None]
    new, old = ([_stacked(one, name) for name in names] for one in (path, clean))
    if any(column is None for column in (*new, *old)) or not 0 < len(new[0]) < len(old[0]):
        return False
    rows = {tuple(column[row].tobytes() for column in old) for row in range(len(old[0]))}
    return all(tuple(column[row].tobytes() for column in new) in rows for row in range(len(new[0])))


def _stacked(path: Path, column: str) -> Any:
    cells = _cells(path, column)
    try:
        return None if cells is None else np.stack([np.asarray(cell) for cell in cells])
    except ValueError:
        return None
