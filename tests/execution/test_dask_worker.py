"""What a worker of a cluster does with a batch of tasks."""

import pytest

import uvshear
from tests.execution import tasks as work
from uvshear.errors import InputError
from uvshear.execution import dask_worker
from uvshear.execution.dask_worker import Answers, version
from uvshear.execution.messages import packed
from uvshear.execution.parcel import Parcel


def _answers(function, shared, tasks, expected=uvshear.__version__) -> Answers:
    asked = packed((function, tasks))
    return dask_worker.work(expected, Parcel.packed(shared), asked).content()


def test_results_are_in_the_order_of_the_tasks() -> None:
    answers = _answers(work.affine, 3, [2, 0, 1])
    assert (answers.results, answers.error) == ([7, 1, 4], None)
    assert answers.seconds > 0


def test_tasks_after_a_failure_are_not_done() -> None:
    answers = _answers(work.inverse, 6, [2, 0, 1])
    assert answers.results == [3]
    assert isinstance(answers.error, ZeroDivisionError)


def test_another_version_of_the_package_does_not_work() -> None:
    answers = _answers(work.affine, 3, [1], expected="0.0.1")
    assert not answers.results
    assert isinstance(answers.error, InputError)
    assert f"uvshear {version()}, but this machine has 0.0.1" in str(answers.error)


def test_a_module_that_a_worker_lacks_is_named() -> None:
    absent = b"cgaussian_beam_of_mine\nbeam\n."  # a pickle that names a class of a module
    with pytest.raises(InputError, match="No module named 'gaussian_beam_of_mine'"):
        dask_worker.unpacked(absent)


def test_libraries_have_one_thread_on_a_worker(client) -> None:
    from uvshear.execution import Dask, Serial

    assert set(Dask(client, Serial()).distribute(work.library_threads, None, range(4))) == {1}
