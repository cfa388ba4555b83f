"""One pass over sources in turn."""

import numpy as np
import pytest

from tests.extraction.converged.states import nothing, touching_pair
from uvshear.execution import SERIAL, Copies, Threads
from uvshear.extraction.converged.moving_sky import MovingSky
from uvshear.extraction.converged.sequential_pass import fit_in_turn

EVERYTHING = np.ones(2, bool)


@pytest.fixture(scope="module")
def prepared():
    return touching_pair()


def in_turn(sky, active, executor, *, afresh):
    with executor.crew(sky) as crew:
        return fit_in_turn(sky, active, crew, nothing, afresh=afresh)


def _error(prepared, sky):
    return np.abs(prepared.ellipticities(sky.now) - prepared.truth.ellipticity)


def test_the_fainter_is_fitted_against_the_brighter_as_it_was_found(prepared):
    """After one pass the second was fitted beside an ellipse, the first beside a circle."""
    sky = MovingSky(prepared.state)
    change = in_turn(sky, EVERYTHING, SERIAL, afresh=True)
    assert np.all(change > 10)
    first, second = _error(prepared, sky)
    assert second < 0.7 * first


def test_more_passes_come_closer(prepared):
    sky, errors = MovingSky(prepared.state), []
    for number in range(3):
        in_turn(sky, EVERYTHING, SERIAL, afresh=number == 0)
        errors.append(_error(prepared, sky).max())
    assert errors[2] < errors[1] < errors[0]


def test_sources_that_are_not_active_stay(prepared):
    sky = MovingSky(prepared.state)
    change = in_turn(sky, np.array([False, True]), SERIAL, afresh=True)
    assert sky.now.fits[0] is prepared.state.fits[0]
    assert change[0] == 0
    assert change[1] > 10
    idle = MovingSky(prepared.state)
    assert not in_turn(idle, ~EVERYTHING, SERIAL, afresh=True).any()


def test_executors_change_no_bit(prepared):
    skies = [MovingSky(prepared.state) for _ in range(3)]
    for sky, executor in zip(skies, (SERIAL, Threads(2), Copies(2)), strict=True):
        for number in range(2):
            in_turn(sky, EVERYTHING, executor, afresh=number == 0)
    first, *others = (prepared.ellipticities(sky.now) for sky in skies)
    for other in others:
        np.testing.assert_array_equal(other, first)
