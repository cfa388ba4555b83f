"""The stages of a simulation."""

from dataclasses import replace

import numpy as np
import pytest

from tests.io.measurement_sets import simulated
from tests.progress.heard import Heard
from uvshear.execution import SERIAL, in_threads
from uvshear.progress import Meter
from uvshear.simulation import observation as module
from uvshear.simulation.in_stages import blocks_in_stages

CHANNELS = 4


@pytest.fixture
def _small_parts(monkeypatch):
    """Six hundred visibilities in a block, and twelve hundred in a prediction."""
    monkeypatch.setattr(module, "SAMPLES_PER_SLAB", 150 * CHANNELS)
    monkeypatch.setattr(module, "SLABS_PER_BLOCK", 1)
    monkeypatch.setattr(module, "BLOCKS_PER_PREDICTION", 2)


def heard(observation, executor=SERIAL):
    """Return what an observer hears, and the blocks."""
    listener = Heard()
    blocks = list(blocks_in_stages(observation, executor, Meter(listener)))
    return listener, blocks


def test_one_prediction_is_followed_by_writing():
    listener, blocks = heard(simulated())
    assert listener.all[0] == ("begin", "prediction", ("writing",))
    assert listener.stages == ["prediction", "writing"]
    assert len(blocks) == 1
    assert listener.all[-1] == ("advance", 1680 * 4, 1680 * 4)


@pytest.mark.usefixtures("_small_parts")
@pytest.mark.parametrize("executor", [SERIAL, in_threads(2)])
def test_stages_follow_one_another_as_foreseen(executor):
    observation = simulated()
    listener, blocks = heard(observation, executor)
    names = [f"{what} {k + 1} of 6" for k in range(6) for what in ("prediction", "writing")]
    assert listener.stages == names
    assert [what[2] for what in listener.all if what[0] == "begin"] == [
        tuple(names[k + 1 :]) for k in range(12)
    ]
    expected = list(observation.blocks())
    assert len(blocks) == len(expected) == 12
    for block, other in zip(blocks, expected, strict=True):
        assert block.first_row == other.first_row
        np.testing.assert_array_equal(block.correlations, other.correlations)


@pytest.mark.usefixtures("_small_parts")
def test_every_stage_ends_when_all_its_visibilities_are_done():
    listener, _ = heard(simulated())
    ends = [
        before
        for before, after in zip(listener.all, [*listener.all[1:], ("begin",)], strict=True)
        if after[0] == "begin"
    ]
    assert [each[1:] for each in ends] == [
        pytest.approx((n, n)) for n in (300 * 4,) * 10 + (180 * 4,) * 2
    ]


def test_a_block_counts_when_it_has_been_used():
    listener = Heard()
    blocks = blocks_in_stages(simulated(), SERIAL, Meter(listener))
    next(blocks)
    assert listener.all[-1][:2] == ("begin", "writing")
    assert next(blocks, None) is None
    assert listener.all[-1][0] == "advance"


def test_an_observation_without_rows_has_no_stages():
    observation = simulated()
    empty = replace(observation, coverage=observation.coverage.rows(slice(0, 0)))
    listener, blocks = heard(empty)
    assert (listener.all, blocks) == ([], [])
