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


def test_half_a_cell_turns_the_phase_at_the_edge_by_0_46_rad() -> None:
    for width in (2.0, 30.0, 84.0):
        cells = Cells.for_field(width * ARCMIN)
        assert _turn(cells, width / 2 * ARCMIN) == pytest.approx((0.46, 0.46), abs=2e-3)


@pytest.mark.parametrize("accuracy", [1e-5, 2.5e-4, 5e-3])
def test_the_accuracy_is_the_error_of_the_gaussian(accuracy: float) -> None:
    cells = Cells.for_field(30 * ARCMIN, accuracy)
    phase = np.linspace(-1, 1, 200_001) * _turn(cells, 15 * ARCMIN)[0]
    error = math.exp(-np.mean(phase**2) / 2) - np.mean(np.cos(phase))
    assert error == pytest.approx(accuracy, rel=0.12)


@pytest.mark.parametrize("width", [0.0, -1.0, math.nan, 11 * 60.0])
def test_a_field_without_a_width_is_refused(width: float) -> None:
    with pytest.raises(InputError, match="arcmin wide; more than 0 and at most 600"):
        Cells.for_field(width * ARCMIN)


@pytest.mark.parametrize("accuracy", [0.0, -1e-3, math.nan, 0.2])
def test_an_accuracy_that_means_nothing_is_refused(accuracy: float) -> None:
    with pytest.raises(InputError, match="a number above 0 and up to"):
        Cells.for_field(30 * ARCMIN, accuracy)
