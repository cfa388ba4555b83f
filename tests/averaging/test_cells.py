"""Sizes of cells."""

import math

import numpy as np
import pytest

from uvshear.averaging.cells import Cells
from uvshear.constants import ARCMIN
from uvshear.errors import InputError


def _turn(cells: Cells, radius: float) -> tuple[float, float]:
    """Phase over half a cell along u and along w, at a distance from the phase centre [rad]."""
    n = math.sqrt(1 - radius**2) - 1
    return 2 * math.pi * cells.uv / 2 * radius, 2 * math.pi * cells.w / 2 * abs(n)


def test_half_a_cell_turns_the_phase_at_the_edge_by_0_63_rad() -> None:
    for width in (2.0, 30.0, 84.0):
        cells = Cells.for_field(width * ARCMIN)
        assert cells.turn == pytest.approx(0.634, abs=1e-3)
        assert _turn(cells, width / 2 * ARCMIN) == pytest.approx((cells.turn,) * 2, rel=1e-4)


@pytest.mark.parametrize("accuracy", [0.01, 0.06, 0.15])
def test_the_accuracy_is_what_a_linear_function_of_the_coordinates_leaves(accuracy: float) -> None:
    cells = Cells.for_field(30 * ARCMIN, accuracy)
    phase = np.linspace(-1, 1, 200_001) * _turn(cells, 15 * ARCMIN)[0]
    signal = np.exp(1j * phase)
    kept = abs(np.mean(signal)) ** 2 + abs(np.mean(phase * signal)) ** 2 / np.mean(phase**2)
    assert math.sqrt(1 - kept) == pytest.approx(accuracy, rel=0.06)


def test_a_direction_without_a_node_costs_six_times_as_much() -> None:
    cells = Cells.for_field(30 * ARCMIN)
    turned = (2 * cells.turn) ** 2 * cells.smallest_scatter
    assert turned == pytest.approx(6 * 0.06**2, rel=1e-6)


@pytest.mark.parametrize("width", [0.0, -1.0, math.nan, 11 * 60.0])
def test_a_field_without_a_width_is_refused(width: float) -> None:
    with pytest.raises(InputError, match="arcmin wide; more than 0 and at most 600"):
        Cells.for_field(width * ARCMIN)


@pytest.mark.parametrize("accuracy", [0.0, -1e-3, math.nan, 0.6])
def test_an_accuracy_that_means_nothing_is_refused(accuracy: float) -> None:
    with pytest.raises(InputError, match="a number above 0 and up to"):
        Cells.for_field(30 * ARCMIN, accuracy)
