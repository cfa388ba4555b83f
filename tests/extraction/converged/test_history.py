import json

import numpy as np
import pytest

from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.minor_cycle import MOST_ITERATIONS


def test_one_major_cycle_may_be_followed_by_a_change_as_large():
    history = History().with_cycle(np.array([3.0, 4.0]), ((4.0, 0.1),))
    assert len(history) == 1
    assert history.left_undone == pytest.approx(np.sqrt(12.5))
    assert history.left_undone_most == 4.0


def test_changes_shrink_by_the_same_factor_again():
    history = History().with_cycle(np.array([8.0]), ()).with_cycle(np.array([2.0]), ())
    assert history.left_undone == pytest.approx(0.5)
    assert history.left_undone_most == pytest.approx(0.5)


def test_changes_that_grow_are_not_taken_to_grow_further():
    history = History().with_cycle(np.array([1.0]), ()).with_cycle(np.array([2.0]), ())
    assert history.left_undone == 2.0


def test_a_sky_that_did_not_change_leaves_nothing_undone():
    history = History().with_cycle(np.zeros(2), ()).with_cycle(np.zeros(2), ())
    assert history.left_undone == 0


def test_the_record_is_what_json_knows():
    history = History().with_cycle(np.array([3.0, 4.0]), ((4.00049, 0.1), (1.0, 0.0)))
    record = json.loads(json.dumps(history.record()))
    assert record == {
        "major_cycles": 1,
        "minor_cycles": [[[4.0, 0.1], [1.0, 0.0]]],
        "change_rms": [3.5355],
        "change_max": [4.0],
        "left_undone": 3.5355,
        "left_undone_most": 4.0,
    }


def test_the_last_cycle_is_what_json_knows():
    history = History().with_cycle(np.array([3.0, 4.0]), ((4.0, 0.1),))
    history = history.with_cycle(np.array([1.0, 1.0]), ((1.00049, 0.1),))
    assert json.loads(json.dumps(history.last())) == {
        "change_rms": 1.0,
        "change_max": 1.0,
        "left_undone": 0.2828,
        "moves": [[1.0, 0.1]],
    }


@pytest.mark.parametrize(
    ("changes", "diverges"),
    [
        ((5.0,), False),
        ((18.0, 4.0), False),
        ((18.0, 4.0, 7.0), True),
        ((0.05, 0.5), False),
        ((9.0, 9.0), False),
    ],
)
def test_a_sky_diverges_where_changes_above_the_noise_grow(changes, diverges):
    history = History()
    for change in changes:
        history = history.with_cycle(np.array([change]), ())
    assert history.is_diverging is diverges


def test_sources_that_still_move_after_the_last_iteration_are_restless():
    change, move = np.array([1.0]), (2.0, 1.0)
    assert not History().is_restless
    assert not History().with_cycle(change, (move,)).is_restless
    restless = History().with_cycle(change, (move,) * MOST_ITERATIONS)
    assert restless.is_restless
    assert not restless.with_cycle(change, (move,)).is_restless
