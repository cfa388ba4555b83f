"""A sky in the form in which it is stored is the same sky when it is made again."""

import pickle

import numpy as np
import pytest

from tests.extraction.converged.states import nothing, touching_pair
from uvshear.execution import SERIAL
from uvshear.extraction.converged.kept_sky import KeptSky
from uvshear.extraction.converged.minor_cycle import run_minor_cycle


@pytest.fixture(scope="module")
def moved():
    """A sky after a minor cycle, whose image holds changes."""
    prepared = touching_pair()
    state = run_minor_cycle(prepared.state, 0.1, SERIAL, nothing, afresh=True).state
    return prepared, state


def _again(kept, prepared):
    return pickle.loads(pickle.dumps(kept, 5)).restored(
        prepared.modelled.sources, prepared.state.interaction.beams
    )


def test_the_sky_is_the_same_to_the_bit(moved):
    prepared, state = moved
    again = _again(KeptSky.from_state(state), prepared)
    for k in range(len(state.fits)):
        for facet in ("facet", "residual"):
            then, now = getattr(state, facet)(k), getattr(again, facet)(k)
            assert np.array_equal(then.correlation, now.correlation)
            assert np.array_equal(then.power, now.power)
    assert np.any(again.image._pixels != 0)
    assert np.array_equal(again.image._pixels, state.image._pixels)
    assert again.neighbourhood.units == state.neighbourhood.units


def test_the_next_minor_cycle_is_the_same_to_the_bit(moved):
    prepared, state = moved
    again = _again(KeptSky.from_state(state), prepared)
    first, second = (
        run_minor_cycle(sky, 1e-3, SERIAL, nothing, afresh=False) for sky in (state, again)
    )
    assert first.moves == second.moves
    assert np.array_equal(first.change, second.change)


def test_for_another_major_cycle_the_fits_are_enough(moved):
    prepared, state = moved
    kept = KeptSky.for_another_major_cycle(state)
    again = _again(kept, prepared)
    assert kept.facets == ()
    assert len(kept.changes.blocks) == 0
    assert [fit.flux for fit in again.fits] == [fit.flux for fit in state.fits]
    assert [fit.flux for fit in again.subtracted] == [fit.flux for fit in state.subtracted]
    informations = (sky.linearisation.equations[0].information for sky in (state, again))
    assert np.array_equal(*informations)
