"""A draw of rows whose number is not known beforehand."""

import numpy as np
import pytest

from uvshear.interferometer.reservoir import Reservoir


def filled(most: int, sizes: list[int], start: int = 0) -> Reservoir:
    """Rows that hold their own numbers, in parts of these sizes."""
    reservoir = Reservoir(most)
    for size in sizes:
        places, numbers = reservoir.draw(size)
        reservoir.add(numbers, (start + places, 2.0 * (start + places)))
        start += size
        assert len(reservoir) <= 2 * most
    return reservoir


@pytest.mark.parametrize("sizes", [[10_000], [100] * 100, [9000, 500, 500], [500, 500, 9000]])
def test_rows_are_drawn_evenly_whatever_the_parts(sizes):
    rows, doubled = filled(1000, sizes).columns()
    assert len(rows) == 1000
    np.testing.assert_array_equal(doubled, 2.0 * rows)
    assert np.all(np.diff(rows) > 0)
    tenths = np.bincount(rows // 1000, minlength=10)
    # 100 each, with a scatter of 10; a part that is drawn twice as often as others: 200
    assert np.all(np.abs(tenths - 100) < 40)


def test_a_few_rows_are_all_kept():
    rows, _ = filled(1000, [300, 300]).columns()
    np.testing.assert_array_equal(rows, np.arange(600))


def test_nothing_is_drawn_from_nothing():
    assert filled(10, [0]).columns() == ()
    assert Reservoir(10).columns() == ()


@pytest.mark.parametrize(("before", "after"), [(9000, 1000), (1000, 9000), (900, 4000)])
def test_a_merged_draw_is_even(before, after):
    first = filled(1000, [before])
    first.merge(filled(1000, [after], start=before))
    (rows, _) = first.columns()
    assert 800 < len(rows) <= 1000
    share = np.mean(rows < before)
    # Of 1000: 1.5 per cent. With all 900 of the first part: 0.46
    assert share == pytest.approx(before / (before + after), abs=0.05)
