"""The paper's extraction, interrupted at any moment, gives the same bits."""

from dataclasses import replace

import pytest

from tests.extraction.fields import OPTIONS, field_of, pair
from tests.extraction.stores import InterruptingStore, InterruptionError
from uvshear.extraction import PaperExtraction
from uvshear.extraction.paper import extraction as of_paper
from uvshear.extraction.paper.exact import ExactFacets
from uvshear.extraction.paper.paper_sky import PaperSky
from uvshear.extraction.paper.paper_state import PaperState
from uvshear.pipeline.identity import canonical
from uvshear.shapes.measurement import FitFlag


@pytest.fixture(scope="module")
def scene():
    observation, catalogue, _ = pair()
    return observation, field_of(observation, catalogue)


def test_the_batches_are_counted(scene):
    _, field = scene
    sky = PaperSky(field.sky)
    reached = PaperState(sky).with_sky(sky).with_sky(sky)
    assert reached.batches == 2
    assert reached.measurements == {}


@pytest.mark.parametrize("bad", [frozenset(), frozenset({FitFlag.OK})], ids=["good", "bad"])
def test_an_extraction_that_was_interrupted_anywhere_ends_with_the_same_bits(
    scene, bad, monkeypatch
):
    """With the flag ``ok`` among the bad ones, all sources are measured again."""
    monkeypatch.setattr(of_paper, "BAD", bad)
    observation, field = scene
    paper = PaperExtraction(ExactFacets(), passes=2)

    def run(store):
        return paper.extract(observation, field, replace(OPTIONS.setting, store=store))

    store = InterruptingStore()
    expected, events = canonical(run(store)), store.events
    assert events == ["sky"] * (6 if bad else 4)
    for moment in range(1, len(events) + 1):
        store = InterruptingStore()
        with pytest.raises(InterruptionError):
            run(store.interrupted_after(moment))
        assert canonical(run(store.interrupted_after(10**9))) == expected
        assert len(store.events) == len(events)


def test_a_sky_that_was_stored_has_the_powers_of_its_facets(scene):
    """Otherwise the next pass would gather them anew."""
    observation, field = scene
    store = InterruptingStore()
    paper = PaperExtraction(ExactFacets(), passes=2)
    paper.extract(observation, field, replace(OPTIONS.setting, store=store))
    kept = store.load("sky")
    assert sorted(kept.sky.power) == [0, 1]
    assert all(len(power) > 100 for power in kept.sky.power.values())
