"""An extraction that is interrupted at any moment, and goes on from what is stored, gives the same bits."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.states import touching_pair
from tests.extraction.fields import OPTIONS, field_of, pair
from tests.extraction.stores import InterruptingStore, InterruptionError
from uvshear.estimators.moments import Moments
from uvshear.execution import Copies, Resources
from uvshear.extraction.converged.baselines import Baselines
from uvshear.extraction.converged.extraction_state import (
    ExtractionState,
    load_baselines,
    load_extraction,
    save_extraction,
)
from uvshear.extraction.converged.history import History
from uvshear.pipeline.identity import canonical


@pytest.fixture(scope="module")
def scene():
    """Two galaxies that touch, with noise, which need several cycles."""
    observation, catalogue, _ = pair()
    (block,) = observation.blocks
    noise = np.random.default_rng(1).normal(size=(2, *block.stokes_i.shape))
    noisy = replace(block, stokes_i=block.stokes_i + 1e-4 * (noise[0] + 1j * noise[1]))
    observation = replace(observation, blocks=(noisy,))
    return observation, field_of(observation, catalogue)


def _extract(scene, store, resources=OPTIONS.resources):
    observation, field = scene
    setting = replace(OPTIONS.setting, keep=(Moments(),), store=store, resources=resources)
    return OPTIONS.method.extraction.extract(observation, field, setting)


@pytest.fixture(scope="module")
def whole(scene):
    """The extraction without interruption, and the events of its store."""
    store = InterruptingStore()
    extracted = _extract(scene, store)
    return canonical(extracted), store.events


def test_every_stage_is_stored(whole):
    _, events = whole
    assert events.count("sky") >= 4  # two major cycles and their minor cycles
    assert events.index("beams") < events.index("sky")
    assert "minor-cycle" in events
    last = [each for each in events if each.partition(".")[2] != "minor-cycle"]
    assert last[-7:] == [*["posteriors"] * 2, *["release.sky"] * 3, *["statistics"] * 2]


def test_an_extraction_that_was_interrupted_anywhere_ends_with_the_same_bits(scene, whole):
    expected, events = whole
    for moment in range(1, len(events) + 1):
        store = InterruptingStore()
        with pytest.raises(InterruptionError):
            _extract(scene, store.interrupted_after(moment))
        again = _extract(scene, store.interrupted_after(10**9))
        assert canonical(again) == expected, events[:moment]
        # What was stored is not done again.
        assert len(store.events) <= len(events) + 1


def test_an_extraction_that_is_interrupted_again_and_again_ends_with_the_same_bits(scene, whole):
    expected, _ = whole
    store = InterruptingStore()
    for _ in range(100):
        try:
            again = _extract(scene, store.interrupted_after(2), Resources(Copies(2)))
        except InterruptionError:
            continue
        assert canonical(again) == expected
        return
    pytest.fail("it does not get on")


def _baselines(shortest):
    return Baselines(shortest, 1e5, 1e5, np.full(2, 1e5), shortest)


def test_a_state_of_other_baselines_is_not_taken_up():
    store = InterruptingStore()
    assert load_baselines(store, _baselines(10.0)).shortest == 10.0
    save_extraction(store, ExtractionState(_baselines(0.0), History((1.0,), (2.0,), ((),))))
    assert load_baselines(store, _baselines(10.0)).shortest == 0.0
    modelled = touching_pair().modelled
    assert len(load_extraction(store, _baselines(0.0), modelled).history) == 1
    assert len(load_extraction(store, _baselines(10.0), modelled).history) == 0


def test_a_state_whose_beams_are_not_stored_begins_anew():
    """The disk may have been full for a moment."""
    prepared = touching_pair()
    store, used = InterruptingStore(), prepared.planner.baselines
    save_extraction(store, ExtractionState(used, sky=prepared.state, awaits_minor_cycle=True))
    assert load_extraction(store, used, prepared.modelled).awaits_minor_cycle
    del store.states["beams"]
    assert load_extraction(store, used, prepared.modelled).sky is None


def test_nothing_is_stored_before_a_minor_cycle_unless_much_would_be_lost():
    store = InterruptingStore()
    store.is_due = False
    save_extraction(store, ExtractionState(_baselines(0.0), awaits_minor_cycle=True))
    assert store.events == []
    save_extraction(store, ExtractionState(_baselines(0.0)))
    assert store.events == ["sky"]
