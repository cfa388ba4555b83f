"""Tables of cells; their sums are tested through the averager."""

import pickle

import numpy as np
import pytest

from uvshear.averaging.cell_table import SMALLEST, CellTable, RowsToAverage
from uvshear.averaging.cells import Cells
from uvshear.averaging.sub_bands import SubBand
from uvshear.interferometer.visibilities import Visibilities

BAND = SubBand(218)
CELLS = Cells(10.0, 100.0, 0.7)


def _seen(uvw) -> RowsToAverage:
    rows = len(uvw)
    seen = Visibilities(
        uvw=np.array(uvw, float),
        frequency=np.array([BAND.frequency]),
        stokes_i=np.ones((rows, 1), np.complex64),
        weights=np.ones((rows, 1), np.float32),
    )
    return RowsToAverage.from_visibilities(seen)


def _far_apart(count: int) -> np.ndarray:
    place = np.arange(count)
    return np.column_stack([place % 97, place // 97 + 1, place % 3]) * (
        BAND.metres * np.array([CELLS.uv, CELLS.uv, CELLS.w])
    )


def test_a_full_table_says_where_to_go_on() -> None:
    table, seen = CellTable(CELLS, BAND), _seen(_far_apart(SMALLEST + 50))
    row = table.add(seen, 0)
    assert (row, len(table)) == (SMALLEST, SMALLEST)
    table.grow()
    assert table.room == 2 * SMALLEST
    assert table.add(seen, row) == len(seen)
    (averages,) = table.taken()
    np.testing.assert_allclose(averages.uvw, seen.uvw, rtol=0, atol=1e-9)
    assert len(table) == 0


def test_a_table_that_was_sent_has_its_cells_and_takes_others() -> None:
    table, seen = CellTable(CELLS, BAND), _seen(_far_apart(50))
    table.add(seen, 0)
    message = pickle.dumps(table)
    assert len(message) < 420 * 50 + 1000  # no memory that holds no cell
    sent, twice = pickle.loads(message), pickle.loads(message)
    sent.add_cells(pickle.loads(message))
    assert len(sent) == 50
    (averages,) = sent.taken()
    np.testing.assert_allclose(averages.uvw, seen.uvw, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(averages.weights, 2.0)
    np.testing.assert_array_equal(next(twice.taken()).weights, 1.0)


def test_a_table_foresees_how_much_it_will_grow() -> None:
    table = CellTable(CELLS, BAND)
    table.add(_seen(_far_apart(SMALLEST - 2)), 0)
    assert table.room_with(2) == SMALLEST
    assert table.room_with(3) == 2 * SMALLEST
    assert len(table) == SMALLEST - 2


def test_a_table_that_was_emptied_can_be_used_again() -> None:
    table, seen = CellTable(CELLS, BAND), _seen(_far_apart(30))
    table.add(seen, 0)
    (first,) = table.taken()
    table.add(seen, 0)
    (again,) = table.taken()
    np.testing.assert_array_equal(first.uvw, again.uvw)
    np.testing.assert_array_equal(again.weights, 1.0)


def test_a_cell_of_one_sample_has_no_scatter() -> None:
    table = CellTable(CELLS, BAND)
    table.add(_seen([(123.4567, 89.0123, -45.678)]), 0)
    (averages,) = table.taken()
    np.testing.assert_allclose(averages.uvw, [(123.4567, 89.0123, -45.678)], rtol=1e-12)
    np.testing.assert_allclose(averages.rows.second, 0.0, rtol=0, atol=1e-12)
    assert averages.rows.frequency[0] == pytest.approx(BAND.frequency, rel=1e-12)


def test_cells_on_both_sides_of_the_origin_are_told_apart() -> None:
    size = BAND.metres * CELLS.uv
    places = [
        (i * size, j * size, k * 100 * BAND.metres)
        for i in (-2, -1, 0, 1, 2)
        for j in (1, 2)
        for k in (-2, 0, 3)
    ]
    table = CellTable(CELLS, BAND)
    table.add(_seen(places), 0)
    (averages,) = table.taken()
    np.testing.assert_allclose(averages.uvw, places, rtol=0, atol=1e-9)


def test_other_frequencies_are_left_to_other_tables() -> None:
    table, seen = CellTable(CELLS, SubBand(230)), _seen(_far_apart(3))
    assert table.add(seen, 0) == 3
    assert len(table) == 0
