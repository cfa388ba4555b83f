"""Passes over sources in decreasing flux."""

import numpy as np
import pytest

from tests.extraction.fields import BRIGHT, FAINT, OPTIONS, field_of, pair
from uvshear.constants import ARCSEC
from uvshear.extraction.paper import sequential_pass
from uvshear.extraction.paper.exact import ExactFacets
from uvshear.extraction.paper.paper_sky import PaperSky
from uvshear.extraction.paper.paper_state import PaperState
from uvshear.extraction.paper.sequential_pass import SequentialPass, batches
from uvshear.shapes.measurement import FitFlag


@pytest.fixture(scope="module")
def scene():
    observation, catalogue, truth = pair()
    return observation, field_of(observation, catalogue), truth


def _run(scene, on_rows=lambda rows: None):
    observation, field, _ = scene
    return SequentialPass(observation, field, OPTIONS.setting, ExactFacets(), on_rows)


def test_neighbours_are_fitted_in_turn_and_the_brighter_first(scene):
    _, field, _ = scene
    order = batches(field, field.measured, 60 * ARCSEC)
    assert [batch.tolist() for batch in order] == [[BRIGHT], [FAINT]]
    assert [batch.tolist() for batch in batches(field, field.measured, ARCSEC)] == [[BRIGHT, FAINT]]


def test_a_batch_is_no_larger_than_memory_allows(scene, monkeypatch):
    _, field, _ = scene
    monkeypatch.setattr(sequential_pass, "FACETS_AT_A_TIME", 1)
    assert [len(batch) for batch in batches(field, field.measured, ARCSEC)] == [1, 1]


def test_each_pass_improves_the_sky(scene):
    _, field, truth = scene
    reached = PaperState(PaperSky(field.sky))
    skies = [reached.sky]
    for _ in range(2):
        for batch in batches(field, field.measured, 60 * ARCSEC):
            reached = _run(scene).improve(reached, batch)
        skies.append(reached.sky)
    errors = [np.abs(sky.sky.ellipticity - truth.ellipticity).max() for sky in skies]
    assert errors[2] < errors[1] < errors[0]
    assert [sky.major_cycles for sky in skies] == [0, 2, 4]
    assert skies[0].sky is field.sky


def test_a_measurement_gives_shapes_and_the_sky_that_they_make(scene):
    observation, field, _ = scene
    rows, reached = [], PaperState(PaperSky(field.sky))
    for batch in batches(field, field.measured, 60 * ARCSEC):
        reached = _run(scene, rows.append).measure(reached, batch)
    shapes = reached.measurements
    assert {shape.flag for shape in shapes.values()} == {FitFlag.OK}
    assert reached.sky.sky.ellipticity[BRIGHT] == shapes[BRIGHT].best.ellipticity
    assert sum(rows) == 2 * len(observation.blocks[0])
    again = _run(scene).measure_again(reached, np.array([FAINT]))
    assert list(again.measured_again) == [FAINT]
    assert again.measurements == shapes
