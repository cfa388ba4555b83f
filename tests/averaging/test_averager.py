"""Averages over cells against sums in plain Python."""

import math
import pickle
from collections import Counter, defaultdict
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from tests.reference.nodes import nodes_of_samples
from uvshear.averaging.averager import Averager
from uvshear.averaging.cells import Cells
from uvshear.averaging.dish_pairs import DishPairs
from uvshear.averaging.sub_bands import SubBand
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.execution import SERIAL, Resources, Threads
from uvshear.interferometer.averaged_rows import SECOND
from uvshear.interferometer.visibilities import Integrations, Visibilities

CELLS = Cells(40.0, 300.0, 0.7)
FREQUENCY = np.linspace(0.9e9, 1.3e9, 7)
BOUNDLESS = Resources(SERIAL, math.inf)
(ALIKE,) = DishPairs.from_diameters([np.full(5, 13.5)])


def _seen(rows: int = 400, seed: int = 1, longest: float = 300.0) -> Visibilities:
    rng = np.random.default_rng(seed)
    shape = (rows, len(FREQUENCY))
    uvw = rng.uniform(-longest, longest, (rows, 3))
    uvw[:5, 1] = 0.0
    weights = rng.uniform(0.5, 2, shape) * (rng.uniform(size=shape) > 0.2)
    vis = (rng.normal(size=shape) + 1j * rng.normal(size=shape)).astype(np.complex64)
    antennas = rng.integers(0, 5, (rows, 2))
    antennas[:, 1] = (antennas[:, 0] + 1 + antennas[:, 1] % 4) % 5
    integrations = Integrations(antennas, rng.uniform(0, 1e4, rows), rng.choice([8.0, 10.0], rows))
    width = np.linspace(1e6, 2e6, len(FREQUENCY))
    return Visibilities(
        uvw, FREQUENCY, vis, weights.astype(np.float32), width, integrations=integrations
    )


def _averaged(chunks, resources=BOUNDLESS, pairs=ALIKE, cells=CELLS):
    found = []
    averager = Averager(cells, lambda *one: found.append(one), resources)
    averager.add(chunks, pairs)
    return found, averager.finish()


def _expected(seen: Visibilities):
    """Return the samples of each sub-band and cell: baselines [wavelengths at the band], weights and so on."""
    groups = defaultdict(list)
    for row in np.lexsort(seen.integrations.antennas.T):
        for chan, frequency in enumerate(seen.frequency):
            weight = float(seen.weights[row, chan])
            if not weight:
                continue
            (band,) = SubBand.of_channels(np.array([frequency]))
            uvw = seen.uvw[row] * frequency / SPEED_OF_LIGHT
            value = complex(seen.stokes_i[row, chan])
            if uvw[1] < 0 or (uvw[1] == 0 and uvw[0] < 0):
                uvw, value = -uvw, value.conjugate()
            cell = tuple(np.rint(uvw / (CELLS.uv, CELLS.uv, CELLS.w)).astype(int).tolist())
            taken = seen.integrations
            groups[band, cell].append(
                (
                    weight,
                    value,
                    uvw,
                    frequency,
                    seen.width[chan],
                    taken.time[row],
                    taken.interval[row],
                )
            )
    return groups


def test_rows_are_the_nodes_of_the_samples_of_each_cell() -> None:
    seen = _seen(longest=80.0)
    expected = _expected(seen)
    found, samples = _averaged([seen])
    assert samples == np.count_nonzero(seen.weights)
    ranks = Counter()
    for group, averages in found:
        scale, row = group.band.frequency / SPEED_OF_LIGHT, 0
        # Cells follow in the order of their first samples.
        for band, cell in [key for key in expected if key[0] == group.band]:
            weight, value, place, frequency, width, time, interval = map(
                np.array, zip(*expected.pop((band, cell)), strict=True)
            )
            size = np.array([CELLS.uv, CELLS.uv, CELLS.w])
            shares, mean, values, moments = nodes_of_samples(
                place / size,
                weight,
                np.column_stack([value, frequency]),
                CELLS.smallest_scatter,
                turned=sum(cell) % 2 == 1,
            )
            rows = slice(row, row := row + len(shares))
            ranks[len(shares)] += 1
            np.testing.assert_allclose(averages.weights[rows], shares * weight.sum(), rtol=1e-7)
            np.testing.assert_allclose(
                averages.stokes_i[rows], values[:, 0], rtol=1e-5, atol=1e-5 * np.abs(value).max()
            )
            np.testing.assert_allclose(averages.uvw[rows] * scale, mean * size, rtol=0, atol=1e-7)
            np.testing.assert_allclose(averages.rows.frequency[rows], values[:, 1].real, rtol=1e-9)
            share = weight / weight.sum()
            np.testing.assert_allclose(
                averages.rows.width[rows] / averages.rows.frequency[rows],
                share @ (width / frequency),
                rtol=1e-12,
            )
            np.testing.assert_allclose(averages.time[rows], share @ time, rtol=1e-12)
            np.testing.assert_allclose(averages.interval[rows], share @ interval, rtol=1e-12)
            own = averages.rows.second[rows] * scale**2
            for column, (a, b) in enumerate(SECOND):
                np.testing.assert_allclose(
                    own[:, column], moments[:, a, b] * size[a] * size[b], rtol=1e-6, atol=1e-5
                )
        assert row == len(averages)
    assert not expected
    assert min(ranks[nodes] for nodes in (1, 2, 3, 4)) > 20


def _same(found, other) -> None:
    for (group, averages), (group_too, others) in zip(found, other, strict=True):
        assert group == group_too
        for name in ("uvw", "stokes_i", "weights", "time", "interval"):
            np.testing.assert_array_equal(getattr(averages, name), getattr(others, name))
        np.testing.assert_array_equal(averages.rows.second, others.rows.second)
        np.testing.assert_array_equal(averages.rows.fourth, others.rows.fourth)


@pytest.mark.parametrize("chunks", [1, 3])
def test_neither_workers_nor_chunks_matter(chunks) -> None:
    seen = _seen(20_000)
    whole, _ = _averaged([seen])
    assert sum(len(averages) for _, averages in whole) > 3 * 4096
    edges = np.linspace(0, len(seen), chunks + 1).astype(int).tolist()
    parts = [seen.of_rows(slice(*pair)) for pair in pairwise(edges)]
    _same(_averaged(parts, Resources(Threads(3), math.inf))[0], whole)


def test_little_memory_makes_more_rows_and_loses_nothing() -> None:
    seen = _seen(20_000)
    whole, samples = _averaged([seen])
    parts, again = _averaged([seen], Resources(SERIAL, 3e6))
    assert again == samples
    assert len(parts) > len(whole)
    for total in (
        lambda averages: averages.weights.sum(),
        lambda averages: (averages.weights * averages.stokes_i).sum(),
        lambda averages: averages.weights @ averages.uvw,
    ):
        sums = [sum(total(averages) for _, averages in one) for one in (parts, whole)]
        np.testing.assert_allclose(*sums, rtol=1e-5)


def test_parts_that_are_merged_are_the_whole() -> None:
    seen = _seen(20_000)
    (whole, _), found = _averaged([seen]), []
    first, later = (
        Averager(CELLS, lambda *one: found.append(one), Resources(SERIAL, math.inf))
        for _ in range(2)
    )
    first.add([seen.of_rows(slice(9000))], ALIKE)
    later.add([seen.of_rows(slice(9000, None))], ALIKE)
    first.merge(pickle.loads(pickle.dumps(later.sums())))
    assert first.finish() == np.count_nonzero(seen.weights)
    for (group, averages), (group_too, others) in zip(found, whole, strict=True):
        assert group == group_too
        # The rows of the parts are added in another order, so that cells are met in another order.
        one, two = (np.lexsort(each.uvw.round(3).T) for each in (averages, others))
        np.testing.assert_allclose(averages.weights[one], others.weights[two], rtol=1e-9)
        np.testing.assert_allclose(averages.uvw[one], others.uvw[two], rtol=0, atol=1e-6)


def test_parts_that_are_merged_in_little_memory_make_more_rows_and_lose_nothing() -> None:
    seen = _seen(20_000)
    found: list = []
    boundless, little = Resources(SERIAL, math.inf), Resources(SERIAL, 3e6)
    total = Averager(CELLS, lambda *one: found.append(one), little)
    for first in range(0, len(seen), 4000):
        part = Averager(CELLS, lambda *one: found.append(one), boundless)
        part.add([seen.of_rows(slice(first, first + 4000))], ALIKE)
        total.merge(part.sums())
    assert total.finish() == np.count_nonzero(seen.weights)
    whole, _ = _averaged([seen])
    assert len(found) > len(whole)
    weight, expected = (sum(a.weights.sum() for _, a in rows) for rows in (found, whole))
    assert weight == pytest.approx(expected, rel=1e-6)


def test_pairs_of_different_dishes_are_averaged_apart() -> None:
    (pairs,) = DishPairs.from_diameters([np.array([13.5, 15.0, 13.5, 15.0, 15.0])])
    seen = _seen()
    found, samples = _averaged([seen], pairs=pairs)
    assert samples == np.count_nonzero(seen.weights)
    assert {group.pair for group, _ in found} == {0, 1, 3}
    assert [pairs.kinds(number) for number in (0, 1, 3)] == [(0, 0), (0, 1), (1, 1)]
    antennas = np.sort(pairs.kind[seen.integrations.antennas], axis=1)
    for number, kinds in {0: (0, 0), 1: (0, 1), 3: (1, 1)}.items():
        chosen = (antennas == kinds).all(axis=1)
        total = sum(averages.weights.sum() for group, averages in found if group.pair == number)
        assert total == pytest.approx(seen.weights[chosen].sum(), rel=1e-6)


def test_the_sign_of_baselines_does_not_matter() -> None:
    seen = _seen()
    turned = replace(seen, uvw=-seen.uvw, stokes_i=seen.stokes_i.conj())
    _same(_averaged([turned])[0], _averaged([seen])[0])


def test_baselines_beyond_the_numbers_of_cells_are_refused() -> None:
    with pytest.raises(ValueError, match="the cells are too small"):
        _averaged([_seen(longest=1e7)], cells=Cells(1e-1, 1e4, 0.7))
