"""Nodes of cells: what they keep of the samples."""

import numpy as np
import pytest

from tests.reference.nodes import nodes_of_samples, squared_loss
from uvshear.averaging.cell_sums import COLUMNS
from uvshear.averaging.nodes.cell_nodes import Nodes
from uvshear.interferometer.averaged_rows import FOURTH, permutations_of

SMALLEST = 1e-3


def _sums(place, weight, vis, frequency):
    """Write the sums of one cell down."""
    u, v, w = place.T
    one = np.ones(len(place))
    columns = [one, vis.real, vis.imag]
    columns += [part * x for x in (u, v, w) for part in (vis.real, vis.imag)]
    columns += [u, v, w, u * u, u * v, u * w, v * v, v * w, w * w]
    columns += [u * u * u, u * u * v, u * u * w, u * v * v, u * v * w, u * w * w]
    columns += [v * v * v, v * v * w, v * w * w, w * w * w]
    columns += [place[:, a] * place[:, b] * place[:, c] * place[:, d] for a, b, c, d in FOURTH]
    columns += [frequency * x for x in (one, u, v, w)]
    columns += [one, one, one]
    assert len(columns) == COLUMNS
    return np.array([[weight @ column for column in columns]])


def _nodes(place, weight, vis, frequency, turned=False):
    return Nodes.of_cells(_sums(place, weight, vis, frequency), SMALLEST, np.array([turned]))


def _samples(count, rank, seed=1):
    rng = np.random.default_rng(seed)
    place = rng.uniform(-0.4, 0.4, (count, 3)) * (np.arange(3) < rank)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    vis = rng.normal(size=count) + 1j * rng.normal(size=count)
    return place @ turn, rng.uniform(0.2, 2, count), vis, rng.uniform(0.95, 1.05, count)


@pytest.mark.parametrize("rank", [0, 1, 2, 3])
@pytest.mark.parametrize(("count", "turned"), [(5, False), (60, True)])
def test_nodes_are_those_of_the_samples(rank, count, turned) -> None:
    place, weight, vis, frequency = _samples(count, rank)
    nodes = _nodes(place, weight, vis, frequency, turned)
    shares, mean, values, moments = nodes_of_samples(
        place, weight, np.column_stack([vis, frequency]), SMALLEST, turned
    )
    assert len(nodes.share) == rank + 1
    np.testing.assert_allclose(nodes.share, shares, atol=1e-12)
    np.testing.assert_allclose(nodes.place, mean, atol=1e-12)
    np.testing.assert_allclose(nodes.stokes_i, values[:, 0], atol=1e-11)
    np.testing.assert_allclose(nodes.frequency, values[:, 1].real, atol=1e-12)
    upper = moments[:, [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]]
    np.testing.assert_allclose(nodes.second, upper, atol=1e-12)

    for direction in np.random.default_rng(4).normal(size=(3, 3)):
        form = [permutations_of(one) * np.prod(direction[list(one)]) for one in FOURTH]
        expected = squared_loss(place, weight, SMALLEST, direction, turned)
        np.testing.assert_allclose(nodes.fourth @ form, expected, rtol=1e-7, atol=1e-12)


@pytest.mark.parametrize("rank", [1, 2, 3])
def test_nodes_keep_sums_up_to_linear_ones_and_moments_up_to_the_second(rank) -> None:
    place, weight, vis, frequency = _samples(40, rank)
    nodes = _nodes(place, weight, vis, frequency)
    share = weight / weight.sum()
    assert nodes.share.sum() == pytest.approx(1, abs=1e-12)
    assert nodes.share @ nodes.stokes_i == pytest.approx(share @ vis, abs=1e-12)
    np.testing.assert_allclose(
        (nodes.share * nodes.stokes_i) @ nodes.place, (share * vis) @ place, atol=1e-12
    )
    second = np.einsum("k,ka,kb->ab", nodes.share, nodes.place, nodes.place)
    np.testing.assert_allclose(second, np.einsum("k,ka,kb->ab", share, place, place), atol=1e-12)


@pytest.mark.parametrize("rank", [1, 2, 3])
def test_the_noise_of_nodes_is_independent_and_as_their_weights_say(rank) -> None:
    place, weight, _, frequency = _samples(12, rank)
    # The response of each node to each sample, by visibilities of 1 in a single sample.
    response = np.array(
        [
            _nodes(place, weight, one.astype(complex), frequency).stokes_i
            for one in np.eye(len(place))
        ]
    ).real
    nodes = _nodes(place, weight, np.ones(12, complex), frequency)
    covariance = response.T @ (response / weight[:, None])
    expected = np.diag(1 / (nodes.share * weight.sum()))
    np.testing.assert_allclose(covariance, expected, atol=1e-12)


def test_two_samples_are_their_own_nodes() -> None:
    place = np.array([[0.1, -0.3, 0.2], [-0.2, 0.4, 0.1]])
    weight, vis = np.array([0.3, 2.0]), np.array([1 + 2j, -0.5j])
    nodes = _nodes(place, weight, vis, np.array([0.97, 1.02]))
    order = np.argsort(nodes.stokes_i.imag)[::-1]
    np.testing.assert_allclose(nodes.place[order], place, atol=1e-12)
    np.testing.assert_allclose(nodes.share[order], weight / weight.sum(), atol=1e-12)
    np.testing.assert_allclose(nodes.stokes_i[order], vis, atol=1e-12)
    np.testing.assert_allclose(nodes.frequency[order], [0.97, 1.02], atol=1e-12)
    np.testing.assert_allclose(nodes.second, 0.0, atol=1e-12)


def test_samples_closer_than_the_smallest_scatter_have_one_node() -> None:
    place, _, vis, frequency = _samples(30, 3)
    place *= 0.9 * np.sqrt(SMALLEST / np.var(place, axis=0, ddof=0).max())
    nodes = _nodes(place, np.ones(30), vis, frequency)
    assert len(nodes.share) == 1
    assert nodes.stokes_i[0] == pytest.approx(vis.mean(), abs=1e-12)
    np.testing.assert_allclose(nodes.place[0], place.mean(axis=0), atol=1e-12)
