"""An observation from any form in which it may be given."""

import shutil

import pytest

from tests.io.measurement_sets import simulated, written
from uvshear.errors import InputError
from uvshear.pipeline.observation import observation_of, paths_of


def test_an_observation_is_itself():
    observation = simulated()
    assert observation_of(observation) is observation
    assert paths_of(observation) == ()


def test_paths_are_opened_one_or_several(tmp_path):
    path = written(tmp_path)
    copy = tmp_path / "copy.ms"
    shutil.copytree(path, copy)
    rows = [
        sum(len(chunk) for chunk in observation_of(given).chunks())
        for given in (path, str(path), [path], (str(path), copy))
    ]
    assert rows == [rows[0]] * 3 + [2 * rows[0]]
    assert paths_of(path) == paths_of(str(path)) == (str(path),)
    assert paths_of([path, copy]) == (str(path), str(copy))


def test_a_path_of_nothing_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        observation_of(tmp_path / "absent.ms")
    with pytest.raises(InputError, match="no file of visibilities is given"):
        observation_of([])
