"""Fits and the image of their changes move together."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.major_cycles import GRIDDING
from tests.extraction.converged.states import touching_pair
from uvshear.execution import SERIAL, Copies, Threads
from uvshear.extraction.converged import moving_sky
from uvshear.extraction.converged.major_cycle import gather_residuals
from uvshear.extraction.converged.moving_sky import Given, Move, MovingSky


@pytest.fixture(scope="module")
def prepared():
    return touching_pair()


def _true_fits(prepared):
    state, truth = prepared.state, prepared.truth
    return [
        replace(fit, ellipticity=complex(e), flux=float(flux))
        for fit, e, flux in zip(state.fits, truth.ellipticity, truth.flux, strict=True)
    ]


def _change(sky):
    with SERIAL.crew(sky) as crew:
        return sky.change(crew)


def test_residuals_after_a_move_are_those_of_another_major_cycle(prepared):
    sky, fits = MovingSky(prepared.state), _true_fits(prepared)
    change = _moved(sky, [0, 1], fits)
    plan = sky.now.interaction.plan
    expected = gather_residuals(
        prepared.observation, plan, prepared.planner.subtracted(fits), GRIDDING
    )
    before = [np.linalg.norm(prepared.state.residual(k).correlation) for k in (0, 1)]
    for k in (0, 1):
        error = np.linalg.norm(sky.now.residual(k).correlation - expected[k])
        # measured 0.023: the longest baselines, which coarse pixels lose
        assert error < 0.04 * before[k]
    np.testing.assert_allclose(change, _change(sky), rtol=0.02)


def test_sources_of_a_group_share_the_change_of_their_sum(prepared):
    state, fits = prepared.state, _true_fits(prepared)
    grouped = replace(state, neighbourhood=replace(state.neighbourhood, units=[[0, 1]]))
    alone, together = MovingSky(state), MovingSky(grouped)
    for sky in (alone, together):
        _moved(sky, [0, 1], fits)
    first, second = _change(together)
    assert first == second
    assert first < np.hypot(*_change(alone))


def test_the_state_that_it_begins_with_stays_as_it_is(prepared):
    state = prepared.state
    facets = [state.facet(k).correlation for k in (0, 1)]
    fits = state.fits
    sky = MovingSky(state)
    _moved(sky, [1], [_true_fits(prepared)[1]])
    assert state.fits is fits
    for k in (0, 1):
        np.testing.assert_array_equal(state.facet(k).correlation, facets[k])
    assert sky.now.fits[0] is fits[0]
    assert sky.now.fits[1] is not fits[1]


def test_moves_do_not_see_one_another_unless_there_are_more_than_slots(prepared, monkeypatch):
    seen = []

    def move(source):
        def find(now):
            seen.append(now.facet(source).correlation)
            return [_true_fits(prepared)[source]]

        return Move([source], find)

    for slots in (1, 2):
        monkeypatch.setattr(moving_sky, "SLOTS", slots)
        sky = MovingSky(prepared.state)
        with SERIAL.crew(sky) as crew:
            sky.move([move(0), move(1)], crew)
    first, after_the_first, _, beside_the_first = seen
    np.testing.assert_array_equal(first, prepared.state.facet(0).correlation)
    assert not np.array_equal(after_the_first, beside_the_first)
    np.testing.assert_array_equal(beside_the_first, prepared.state.facet(1).correlation)


@pytest.mark.parametrize("slots", [1, 512])
def test_executors_change_no_bit(prepared, monkeypatch, slots):
    monkeypatch.setattr(moving_sky, "SLOTS", slots)
    facets = []
    for executor in (SERIAL, Threads(2), Copies(2)):
        sky = MovingSky(prepared.state)
        change = _moved(sky, [0, 1], _true_fits(prepared), executor)
        facets.append([sky.now.facet(0).correlation, sky.now.facet(1).correlation])
        assert np.all(change > 1)
    for other in facets[1:]:
        for k in (0, 1):
            np.testing.assert_array_equal(other[k], facets[0][k])


def test_copies_see_the_moves_of_the_sky(prepared):
    sky, fits = MovingSky(prepared.state), _true_fits(prepared)
    with Copies(2).crew(sky) as crew:
        before = list(crew.map(_correlation, [0, 1, 0, 1]))
        sky.move([Move([k], Given(fit)) for k, fit in enumerate(fits)], crew)
        after = list(crew.map(_correlation, [0, 1, 0, 1]))
    for k, (old, new) in enumerate(zip(before, after, strict=True)):
        np.testing.assert_array_equal(new, _correlation(sky, k % 2))
        assert not np.array_equal(old, new)


def _correlation(sky, source):
    return sky.now.facet(source).correlation


def _moved(sky, sources, fits, executor=SERIAL):
    moves = [Move([k], Given(fit)) for k, fit in zip(sources, fits, strict=True)]
    with executor.crew(sky) as crew:
        return sky.move(moves, crew)
