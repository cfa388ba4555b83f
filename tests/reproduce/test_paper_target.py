from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from uvshear.reproduce.finding import Finding
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.typing import Array


class Slow:
    seconds = 20.0


@dataclass(frozen=True)
class Halves(PaperTarget):
    name = "halves"
    title = "Halves"

    width: float = 0.5

    def tasks(self) -> Mapping[str, Any]:
        return {"first": 1, "second": Slow()}

    def measure(self, task: Any) -> Mapping[str, Array]:
        return {}

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        raise NotImplementedError


def test_settings_are_the_fields_as_text():
    assert Halves(3).settings() == {"seed": "3", "width": "0.5"}


def test_a_task_without_an_estimate_counts_as_a_second():
    assert Halves().seconds() == 21.0
