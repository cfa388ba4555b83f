"""Posteriors of the galaxies of a converged sky."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.states import nothing, touching_pair
from uvshear.execution import SERIAL, in_threads
from uvshear.extraction.converged.minor_cycle import run_minor_cycle
from uvshear.extraction.converged.shapes import measure_shapes
from uvshear.shapes.measurement import FitFlag


@pytest.fixture(scope="module")
def prepared():
    return touching_pair()


@pytest.fixture(scope="module")
def state(prepared):
    state = prepared.state
    for number in range(3):
        state, _ = run_minor_cycle(state, 0.05, SERIAL, nothing, afresh=number == 0)
    return state


@pytest.fixture(scope="module")
def shapes(prepared, state):
    return measure_shapes(state, prepared.modelled, SERIAL, nothing)


def test_every_galaxy_has_its_shape_in_the_catalogues_flux(prepared, shapes):
    truth = prepared.truth
    assert sorted(shapes) == [0, 1]
    for source, shape in shapes.items():
        assert shape.flag is FitFlag.OK
        assert shape.ellipticity @ (1, 1j) == pytest.approx(truth.ellipticity[source], abs=5e-3)
        assert shape.flux == pytest.approx(truth.flux[source], rel=5e-3)


def test_free_neighbours_widen_errors(prepared, state, shapes):
    alone = measure_shapes(replace(state, linearisation=None), prepared.modelled, SERIAL, nothing)
    for source in (0, 1):
        assert shapes[source].e_sigma > alone[source].e_sigma


def test_a_weight_correction_widens_errors_too(prepared, state, shapes):
    field = replace(prepared.modelled.field, weight_correction=np.array([1.0, 0.5]))
    modelled = replace(prepared.modelled, field=field)
    corrected = measure_shapes(state, modelled, SERIAL, nothing)
    assert corrected[0].e_sigma == shapes[0].e_sigma
    assert corrected[1].e_sigma == pytest.approx(np.sqrt(2) * shapes[1].e_sigma, rel=0.05)


def test_executors_change_no_bit_and_every_shape_is_heard_of(prepared, state, shapes):
    heard = []
    again = measure_shapes(state, prepared.modelled, in_threads(2), lambda: heard.append(1))
    assert len(heard) == 2
    for source in (0, 1):
        np.testing.assert_array_equal(again[source].ellipticity, shapes[source].ellipticity)
