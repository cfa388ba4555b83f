"""Passes over the visibilities, and what every accumulator promises."""

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest

from tests.interferometer.chunks import chunk, observation
from uvshear.execution import Executor, Serial, Threads
from uvshear.interferometer.accumulate import Accumulator, accumulate, show
from uvshear.interferometer.baseline_map import BaselineMapAccumulator
from uvshear.interferometer.count_samples import SampleCountsAccumulator
from uvshear.interferometer.noise_sample import NoiseSampleAccumulator
from uvshear.interferometer.ranges import RangesAccumulator
from uvshear.interferometer.summary import SummaryAccumulator

ACCUMULATORS: list[Callable[[], Accumulator[Any]]] = [
    BaselineMapAccumulator,
    lambda: BaselineMapAccumulator(lambda seen: np.exp(-seen.uv_distance / 1e4)),
    SampleCountsAccumulator,
    NoiseSampleAccumulator,
    RangesAccumulator,
    SummaryAccumulator,
]


class Collector(Accumulator[list[float]]):
    """Remembers the first frequency of every chunk, and is satisfied by a number of them."""

    def __init__(self, enough: float = np.inf) -> None:
        self.seen: list[float] = []
        self.enough = enough

    @property
    def is_satisfied(self) -> bool:
        return len(self.seen) >= self.enough

    def add(self, seen: Any) -> None:
        self.seen.append(float(seen.frequency[0]))

    def merge(self, later: "Collector") -> None:
        self.seen += later.seen

    def result(self) -> list[float]:
        return self.seen


def _numbers(result: Any) -> list[Any]:
    """Everything in a result that can be compared, but for the probes, which parts draw with numbers of their own."""
    if isinstance(result, dict):
        return [n for name, value in result.items() if name != "probes" for n in _numbers(value)]
    return _numbers(asdict(result)) if hasattr(result, "__dataclass_fields__") else [result]


@pytest.mark.parametrize("make", ACCUMULATORS)
def test_merged_parts_equal_the_whole(make: Callable[[], Accumulator[Any]]) -> None:
    chunks = [chunk(seed) for seed in range(5)]
    whole, first, second, third = make(), make(), make(), make()
    show(chunks, [whole])
    show(chunks[:2], [first])
    show(chunks[2:3], [second])
    show(chunks[3:], [third])
    first.merge(second)
    first.merge(third)
    for got, expected in zip(_numbers(first.result()), _numbers(whole.result()), strict=True):
        np.testing.assert_allclose(got, expected, rtol=1e-12)


@pytest.mark.parametrize("make", ACCUMULATORS)
def test_a_part_without_visibilities_changes_nothing(make: Callable[[], Accumulator[Any]]) -> None:
    whole = make()
    show([chunk(1)], [whole])
    before = _numbers(whole.result())
    whole.merge(make())
    for got, expected in zip(_numbers(whole.result()), before, strict=True):
        np.testing.assert_array_equal(got, expected)


@pytest.mark.parametrize("executor", [Serial(), Threads(3)])
def test_results_are_in_the_order_of_the_accumulators(executor: Executor) -> None:
    counts, collected, ranges = accumulate(
        observation(1, 2), [SampleCountsAccumulator(), Collector(), RangesAccumulator()], executor
    )
    assert counts.rows == 480
    assert collected == [1.01e9, 1.02e9]
    assert ranges.interval == (9.0, 10.0)


@pytest.mark.parametrize("executor", [Serial(), Threads(3)])
def test_every_accumulator_sees_the_chunks_in_their_order(executor: Executor) -> None:
    results = accumulate(observation(3, 1, 2), [Collector() for _ in range(4)], executor)
    assert results == ([1.03e9, 1.01e9, 1.02e9],) * 4


def test_a_pass_ends_when_all_accumulators_are_satisfied() -> None:
    few, more = accumulate(observation(1, 2, 3, 4), [Collector(1), Collector(3)])
    assert len(few) == len(more) == 3


def test_executors_agree_bit_by_bit() -> None:
    results = [
        accumulate(observation(1, 2, 3), [make() for make in ACCUMULATORS], executor)
        for executor in (Serial(), Threads(2))
    ]
    for one, other in zip(*results, strict=True):
        for got, expected in zip(_numbers(one), _numbers(other), strict=True):
            np.testing.assert_array_equal(got, expected)
