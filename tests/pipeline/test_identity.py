"""What the state of a measurement depends on."""

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import pytest

from tests.extraction.fields import OPTIONS, pair
from uvshear.estimators.moments import Moments
from uvshear.execution import SERIAL, Copies, Resources
from uvshear.execution.once import KeptOnce
from uvshear.extraction import ConvergedExtraction, Method
from uvshear.galaxy import Gaussian
from uvshear.interferometer.first_pass import first_pass
from uvshear.pipeline.identity import canonical, content_of, identity_of, text_of


@pytest.fixture(scope="module")
def inputs():
    observation, catalogue, _ = pair()
    return observation, catalogue


def _differing(inputs, observation=None, catalogue=None, options=OPTIONS):
    then = identity_of(*inputs, OPTIONS)
    now = identity_of(observation or inputs[0], catalogue or inputs[1], options)
    return {name for name in then | now if then.get(name) != now.get(name)}


def test_the_same_measurement_has_the_same_identity_whatever_its_resources(inputs):
    assert _differing(inputs) == set()
    observation, catalogue, _ = pair()
    resources = Resources(Copies(7), 1e9)
    options = replace(OPTIONS, resources=resources)
    assert _differing(inputs, observation, catalogue, options) == set()


def test_what_differs_has_a_name(inputs):
    observation, catalogue = inputs
    (block,) = observation.blocks
    other = replace(block, stokes_i=block.stokes_i * (1 + 1e-12))
    data = replace(observation, blocks=(other,))
    assert _differing(inputs, observation=data) == {"the selection from the observation"}
    moved = replace(catalogue, flux=catalogue.flux * (1 + 1e-12))
    assert _differing(inputs, catalogue=moved) == {"the catalogue"}
    model = replace(OPTIONS, model=replace(OPTIONS.model, profile=Gaussian()))
    assert _differing(inputs, options=model) == {"model.profile"}
    method = replace(OPTIONS, method=Method(ConvergedExtraction(tolerance=0.2)))
    assert _differing(inputs, options=method) == {"method.extraction"}


def test_changes_of_the_files_are_noticed(inputs, tmp_path, field_ms):
    from uvshear.io.observations import open_observation

    path = tmp_path / "copy.ms"
    shutil.copytree(field_ms, path)
    catalogue = inputs[1]

    def state():
        return identity_of(open_observation(path), catalogue, OPTIONS)

    before = state()
    (path / "table.lock").write_bytes(b"somebody has read it")
    assert state() == before
    changed = next(path.glob("table.f*"))
    os.utime(changed, ns=(10**18, 2 * 10**18))
    after = state()
    assert {name for name in before if before[name] != after[name]} == {f"the content of {path}"}


@pytest.fixture(scope="module")
def field_ms(tmp_path_factory):
    from uvshear.cli.application import run

    directory = tmp_path_factory.mktemp("identity")
    words = "--layout vla-a --declination-deg 30 --hours 1 --integration-s 600 --band-mhz 1300 1400 --snr-at 10 50"
    (directory / "c.csv").write_text("id,l,m,flux\n1,0,0,50\n")
    path = directory / "field.ms"
    more = ["--catalogue", directory / "c.csv", "--flux-unit", "uJy", "-o", path]
    assert run(["simulate", *words.split(), *map(str, more)]) == 0
    return path


def test_the_content_of_an_observation_is_that_of_its_visibilities(inputs):
    observation, _ = inputs
    (block,) = observation.blocks
    seen = content_of(first_pass(observation, SERIAL))
    assert content_of(first_pass(observation, Copies(2))) == seen
    weights = block.weights.copy()
    weights[0] *= 1.01
    other = replace(observation, blocks=(replace(block, weights=weights),))
    assert content_of(first_pass(other, SERIAL)) != seen


@dataclass
class _Own:
    values: object


def test_values_are_told_apart():
    texts = [
        canonical(value)
        for value in (
            1,
            1.0,
            True,
            None,
            "1",
            b"1",
            Path("1"),
            np.arange(3),
            np.arange(3.0),
            np.arange(3)[:, None],
            np.array(["a", None], dtype=object),
            (1, 2),
            {1: 2},
            {1, 2},
            np.sum,
            np.ndarray,
            _Own(1),
            _Own((1,)),
        )
    ]
    assert len(set(texts)) == len(texts)
    assert canonical({"b": 1, "a": 2}) == canonical({"a": 2, "b": 1})
    assert text_of("x" * 200) != text_of("x" * 201)
    assert len(text_of("x" * 200)) < 100


class _Memory:
    def __init__(self):
        self.width = 2.0
        self.known = KeptOnce(1e6, float)

    @cached_property
    def area(self):
        return self.width**2


def test_what_was_computed_from_the_rest_does_not_count():
    estimator, other = Moments(), _Memory()
    before = canonical((estimator, other))
    estimator._functionals._known["key"] = 1.0
    other.known.value("key", lambda: 1.0)
    assert other.area == 4
    assert canonical((estimator, other)) == before
    other.width = 3.0
    assert canonical((estimator, other)) != before


def test_an_object_that_contains_itself_has_an_identity():
    own = _Own(None)
    own.values = own
    assert text_of(own) == "_Own"


def test_the_text_is_the_same_in_every_process():
    code = (
        "from uvshear.pipeline.identity import canonical; from uvshear.extraction import Model, Method;"
        " print(canonical((Model(), Method(), {'a', 'b', 'c'})))"
    )
    texts = {
        subprocess.run(
            [sys.executable, "-c", code],
            check=True,
            capture_output=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        ).stdout
        for seed in ("1", "2")
    }
    assert len(texts) == 1
    assert b"ConvergedExtraction(tolerance=0.1" in texts.pop()
