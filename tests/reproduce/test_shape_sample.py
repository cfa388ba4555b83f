import numpy as np
import pytest

from tests.reproduce.surveys import sample_of, small_survey
from uvshear.reproduce.repeats import OppositePairs
from uvshear.reproduce.shape_sample import (
    FLAGS,
    ShapeSample,
    ShapeTask,
    measure_shapes,
    sample_named,
    shape_tasks,
)
from uvshear.shapes.measurement import FitFlag


@pytest.fixture(scope="module")
def sample():
    shears = (0.05j, -0.05j)
    task = ShapeTask(small_survey(shears=shears), 10, 3, OppositePairs())
    return ShapeSample.join([measure_shapes(task)])


def test_there_is_a_row_for_each_galaxy_shear_and_realisation(sample):
    assert len(sample) == 3 * 2 * 4
    rows = set(zip(sample.galaxy, sample.shear, sample.realisation, strict=True))
    assert rows == {(g, s, r) for g in (10, 11, 12) for s in (0, 1) for r in range(4)}


def test_shapes_are_those_of_the_galaxies(sample):
    assert np.all(sample.is_good)
    pulls = (sample.measured - sample.true).real / sample.error[:, 0]
    assert np.abs(pulls).max() < 5
    assert np.abs(sample.true).max() < 1
    assert sample.snr.min() > 50
    first = sample.select((sample.galaxy == 10) & (sample.realisation == 0))
    assert (first.true[0] - first.true[1]).imag == pytest.approx(0.1, abs=0.03)


def test_the_same_task_gives_the_same_shapes():
    task = ShapeTask(small_survey(), 0, 2)
    one, two = measure_shapes(task), measure_shapes(task)
    np.testing.assert_array_equal(one["measured"], two["measured"])


def test_the_time_of_a_task_is_that_of_its_fits():
    task = ShapeTask(small_survey(shears=(0.05j, -0.05j)), 10, 3, OppositePairs())
    assert task.seconds == pytest.approx(3 * 2 * 4 * task.survey.facets.seconds)


def test_slopes_and_weights_leave_out_what_has_a_flag():
    true = np.array([0.3 + 0.1j, -0.2 - 0.3j, 0.1 + 0.2j])
    measured = 0.9 * true
    measured[2] = 5 + 5j
    flag = np.array([0, 0, FLAGS.index(FitFlag.UNRELIABLE)])
    sample = sample_of(measured, true, flag=flag)
    assert [slope.inverse_variance.value for slope in sample.slopes()] == pytest.approx([0.9, 0.9])
    assert sample.weight[2] == 0
    assert np.all(sample.weight[:2] > 0)


def test_tasks_cover_all_galaxies_and_parts_are_found_by_name():
    tasks = dict(shape_tasks("cells-10-20", small_survey(), 5, 2))
    assert list(tasks) == ["cells-10-20-0", "cells-10-20-2", "cells-10-20-4"]
    assert sum(task.number for task in tasks.values()) == 5
    parts = {
        "cells-10-20-0": sample_of([0.1]).arrays(),
        "cells-10-20-2": sample_of([0.2]).arrays(),
        "cells-10-0": sample_of([0.3]).arrays(),
    }
    np.testing.assert_array_equal(sample_named(parts, "cells-10-20").measured, [0.1, 0.2])
