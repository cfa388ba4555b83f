"""Posteriors of the galaxies of a converged sky."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.states import nothing, touching_pair
from uvshear.execution import SERIAL, Copies
from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.minor_cycle import run_minor_cycle
from uvshear.extraction.converged.shapes import measure_shapes
from uvshear.shapes.measurement import FitFlag
from uvshear.shapes.remaining_change import NOTICEABLE

CONVERGED = History((1.0, 1e-6), (1.0, 1e-6), ((), ()))
"""The last of two major cycles has changed next to nothing."""


@pytest.fixture(scope="module")
def prepared():
    return touching_pair()


@pytest.fixture(scope="module")
def state(prepared):
    state = prepared.state
    for number in range(3):
        state = run_minor_cycle(state, 0.05, SERIAL, nothing, afresh=number == 0).state
    return state


@pytest.fixture(scope="module")
def shapes(prepared, state):
    return measure_shapes(state, prepared.modelled, CONVERGED, SERIAL, nothing)


def test_every_galaxy_has_its_shape_in_the_catalogues_flux(prepared, shapes):
    truth = prepared.truth
    assert sorted(shapes) == [0, 1]
    for source, shape in shapes.items():
        assert shape.flag is FitFlag.OK
        assert shape.ellipticity @ (1, 1j) == pytest.approx(truth.ellipticity[source], abs=5e-3)
        assert shape.flux == pytest.approx(truth.flux[source], rel=5e-3)


def test_free_neighbours_widen_errors(prepared, state, shapes):
    alone = measure_shapes(
        replace(state, linearisation=None), prepared.modelled, CONVERGED, SERIAL, nothing
    )
    for source in (0, 1):
        assert shapes[source].e_sigma > alone[source].e_sigma


def test_a_weight_correction_widens_errors_too(prepared, state, shapes):
    field = replace(prepared.modelled.field, weight_correction=np.array([1.0, 0.5]))
    modelled = replace(prepared.modelled, field=field)
    corrected = measure_shapes(state, modelled, CONVERGED, SERIAL, nothing)
    assert corrected[0].e_sigma == shapes[0].e_sigma
    assert corrected[1].e_sigma == pytest.approx(np.sqrt(2) * shapes[1].e_sigma, rel=0.05)


def test_executors_change_no_bit_and_every_shape_is_heard_of(prepared, state, shapes):
    heard = []
    again = measure_shapes(state, prepared.modelled, CONVERGED, Copies(2), lambda: heard.append(1))
    assert len(heard) == 2
    for source in (0, 1):
        np.testing.assert_array_equal(again[source].ellipticity, shapes[source].ellipticity)


def test_a_sky_that_still_moves_has_flags_and_wider_errors(prepared, state, shapes):
    """If another cycle brings a hundredth of the last change, the first galaxy moves by more than half of the noise."""
    moving = History((1.0, 0.01), (1.0, 0.01), ((), ()))
    still = measure_shapes(state, prepared.modelled, moving, SERIAL, nothing)
    for source, shape in still.items():
        (unit,) = (unit for unit in state.neighbourhood.units if source in unit)
        change = state.change_of_unit(unit, state.subtracted)
        assert shape.quality.remaining_change == pytest.approx(0.01 * change, rel=1e-6)
        moved = (
            0.01 / 0.99 * (state.fits[source].ellipticity - state.subtracted[source].ellipticity)
        )
        wider = shapes[source].covariance + np.outer(*[[moved.real, moved.imag]] * 2)
        np.testing.assert_allclose(shape.covariance, wider, rtol=1e-6)
        is_noticeable = shape.quality.remaining_change > NOTICEABLE
        assert (shape.flag is FitFlag.NOT_CONVERGED) == is_noticeable
    assert any(shape.flag is FitFlag.NOT_CONVERGED for shape in still.values())
    assert all(shape.quality.remaining_change < 0.01 for shape in shapes.values())


def test_touching_galaxies_know_how_much_the_other_costs(shapes):
    for shape in shapes.values():
        assert shape.quality.error_widening > 1.01
        assert shape.quality.detection > 50
        assert shape.quality.resolved > 10
