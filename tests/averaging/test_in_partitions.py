"""Averages of a set in a file, with every executor."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from tests.io.measurement_sets import written
from uvshear.averaging import in_partitions
from uvshear.averaging.averager import Averager
from uvshear.averaging.cells import Cells
from uvshear.averaging.dish_pairs import DishPairs
from uvshear.averaging.in_partitions import add_in_partitions, samples_to_average
from uvshear.errors import InputError
from uvshear.execution import Copies, Dask, Resources, Serial, Threads
from uvshear.io.measurement_set.observation import MeasurementSet

CELLS = Cells(300.0, 3000.0, 0.7)


@pytest.fixture(scope="module")
def field(tmp_path_factory) -> MeasurementSet:
    """A set of 20 chunks."""
    return MeasurementSet(written(tmp_path_factory.mktemp("averages")), memory=2**15)


def _pairs(parts):
    return list(
        zip(parts, DishPairs.from_diameters([part.dish_diameters() for part in parts]), strict=True)
    )


def _averaged(parts, executor, memory=math.inf):
    found = []
    resources = Resources(executor, memory)
    averager = Averager(CELLS, lambda *one: found.append(one), resources)
    add_in_partitions(averager, _pairs(parts), CELLS, resources)
    return found, averager.finish()


def _bytes(found) -> list[bytes]:
    names = ("uvw", "stokes_i", "weights", "time", "interval")
    return [getattr(averages, name).tobytes() for _, averages in found for name in names] + [
        rows.tobytes()
        for _, averages in found
        for rows in (averages.rows.second, averages.rows.fourth)
    ]


@pytest.mark.parametrize("memory", [math.inf, 1e6])
def test_all_executors_agree_bit_by_bit(field, client, monkeypatch, memory) -> None:
    monkeypatch.setattr(in_partitions, "SAMPLES", 2000)
    serial, samples = _averaged([field, field], Serial(), memory)
    for executor in (Threads(3), Copies(2), Dask(client, Threads(2))):
        found, count = _averaged([field, field], executor, memory)
        assert [group for group, _ in found] == [group for group, _ in serial]
        assert _bytes(found) == _bytes(serial)
        assert count == samples


def test_partitions_are_the_whole(field, monkeypatch) -> None:
    whole = []
    averager = Averager(CELLS, lambda *one: whole.append(one), Resources(Serial(), math.inf))
    ((part, pairs),) = _pairs([field])
    averager.add(samples_to_average(part), pairs)
    expected = averager.finish()
    assert _bytes(_averaged([field], Serial())[0]) == _bytes(whole)  # a single partition
    monkeypatch.setattr(in_partitions, "SAMPLES", 2000)
    found, samples = _averaged([field], Serial())
    assert samples == expected
    for (group, averages), (group_too, others) in zip(found, whole, strict=True):
        assert group == group_too
        # The baselines of each partition are added one after the other.
        one, two = (np.lexsort(each.uvw.round(3).T) for each in (averages, others))
        np.testing.assert_allclose(averages.weights[one], others.weights[two], rtol=1e-9)
        np.testing.assert_allclose(
            averages.stokes_i[one], others.stokes_i[two], rtol=2e-6, atol=1e-9
        )


def test_a_part_without_weight_is_named(field, monkeypatch) -> None:
    monkeypatch.setattr(in_partitions, "SAMPLES", 2000)
    monkeypatch.setattr(MeasurementSet, "rows_between", lambda *_: iter(()))
    with pytest.raises(InputError, match=r"field.ms: no visibility carries weight"):
        _averaged([field], Serial())


def test_the_texts_name_the_memory_above_which_partitions_depend_on_the_data_alone(
    field, monkeypatch
) -> None:
    class Asked(Exception):  # noqa: N818
        pass

    def asked(_, most):
        raise Asked(most)

    monkeypatch.setattr(in_partitions, "partitions_of", asked)

    def most(memory: float) -> int:
        with pytest.raises(Asked) as found:
            _averaged([field], Serial(), memory)
        return found.value.args[0]

    assert most(10.4e9) < most(10.5e9) == most(math.inf) == in_partitions.SAMPLES
    root = Path(__file__).parents[2]
    for text in ("docs/cluster.md", "src/uvshear/cli/average.py"):
        assert re.search(r"\b10\.5\b", (root / text).read_text(encoding="utf-8"))
