from dataclasses import dataclass

import numpy as np
import pytest

from tests.reproduce.surveys import sample_of, small_survey
from uvshear.constants import MICROJANSKY
from uvshear.reproduce.additive_bias import AdditiveBiasTarget, additive_bias
from uvshear.reproduce.finding import Finding
from uvshear.reproduce.repeats import TurnedPairs


@dataclass(frozen=True)
class TwoCases(AdditiveBiasTarget):
    name = "two-cases"
    title = "Two cases"

    def cases(self):
        return {"first": small_survey(), "second": small_survey(snr=50.0)}

    def galaxies_of(self, case):
        return 3 if case == "second" else self.galaxies

    def finding(self, found) -> Finding:
        raise NotImplementedError


def test_every_case_has_its_galaxies_in_turned_pairs():
    tasks = TwoCases(galaxies=5, block=4).tasks()
    assert {name: task.number for name, task in tasks.items()} == {
        "first-0": 4,
        "first-4": 1,
        "second-0": 3,
    }
    assert all(task.repeats == TurnedPairs() for task in tasks.values())


def test_c_is_that_of_the_galaxies_above_a_flux():
    flux = np.array([10.0, 30.0]) * MICROJANSKY
    parts = {"first-0": sample_of([0.1, 0.3], flux=flux).arrays()}
    assert additive_bias(parts, "first")[0].value == pytest.approx(0.2)
    assert additive_bias(parts, "first", 30)[0].value == pytest.approx(0.3)
