"""Couplings of galaxies against products of their derivatives, and against dense matrices."""

import math

import numpy as np
import pytest

from tests.extraction.converged.coupled_galaxies import coupled_galaxies, couplings_of
from tests.extraction.converged.fisher_matrices import PAIRS, SIX, fisher_matrix, parts_of
from tests.reference import likelihood
from uvshear.execution import Copies, Threads
from uvshear.extraction.converged.couplings import CouplingBlocks


def test_blocks_grow_with_the_fluxes_since_they_were_worked_out():
    """All responses but that to the flux itself are proportional to the flux."""
    equations, couplings, _ = parts_of(fisher_matrix(5), PAIRS)
    flux = np.array([1.0, 2.0, 0.5, 3.0, 1.0])
    ratio = np.ones((5, SIX))
    ratio[:, 1:] = flux[:, None]
    got = couplings.at_flux(flux)
    for (i, j), block, before in zip(PAIRS, got, couplings.blocks, strict=True):
        np.testing.assert_allclose(block, before * np.outer(ratio[i], ratio[j]), rtol=1e-12)
    np.testing.assert_array_equal(couplings.at_flux(np.ones(5)), couplings.blocks)
    assert len(equations) == 5


@pytest.mark.parametrize("gone", [0.0, -1.0])
def test_a_flux_that_vanishes_leaves_its_blocks_finite(gone):
    _, couplings, _ = parts_of(fisher_matrix(5), PAIRS)
    got = couplings.at_flux(np.array([1.0, gone, 1.0, 1.0, 1.0]))
    assert np.all(np.isfinite(got))
    np.testing.assert_array_equal(got, couplings.blocks)


def test_the_sparse_matrix_is_the_dense_one():
    equations, couplings, dense = parts_of(fisher_matrix(5), PAIRS)
    scale = np.sqrt(np.diag(dense)).reshape(5, SIX)
    own = np.array([source.information for source in equations]) / (
        scale[:, :, None] * scale[:, None]
    )
    got = couplings.blocks_with_diagonal(own, scale, np.ones(5)).toarray()
    for i in range(5):
        dense[SIX * i, ::SIX] -= couplings.far.toarray()[i]
    expected = dense / np.outer(scale.ravel(), scale.ravel())
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12)


def test_a_block_is_found_from_either_side():
    _, couplings, _ = parts_of(fisher_matrix(5), PAIRS)
    blocks = CouplingBlocks(couplings, np.ones(5))
    np.testing.assert_array_equal(blocks.between(1, 2), couplings.blocks[2])
    np.testing.assert_array_equal(blocks.between(2, 1), couplings.blocks[2].T)
    assert blocks.between(0, 2) is None


@pytest.fixture(scope="module")
def coupled():
    return coupled_galaxies()


def test_each_pair_within_reach_is_coupled_once(coupled):
    pairs = list(
        zip(coupled.couplings.first.tolist(), coupled.couplings.second.tolist(), strict=True)
    )
    reach = coupled.interaction.reach
    expected = [
        (i, j)
        for i in range(10)
        for j in range(i + 1, 10)
        if np.hypot(*(coupled.place[i] - coupled.place[j])) <= reach
    ]
    assert 5 < len(expected) < 45
    assert sorted(pairs) == expected


def _responses(uv, theta, place):
    return likelihood.derivatives(lambda x: likelihood.galaxy(uv, x, tuple(place)), theta)


def test_a_block_is_the_product_of_the_galaxies_derivatives_under_the_beam(coupled):
    thetas = [
        np.array([fit.flux, 0.2, -0.1, math.log(fit.scale_length), 0.0, 0.0])
        for fit in coupled.fits
    ]
    own = {}
    for i, j, block in zip(
        coupled.couplings.first, coupled.couplings.second, coupled.couplings.blocks, strict=True
    ):
        cells = coupled.interaction.short_plane_around(int(i))
        responses = {
            k: _responses(cells.uv, thetas[k], coupled.place[k] - coupled.place[i]) for k in (i, j)
        }
        for k in (i, j):
            own[k] = np.sqrt(np.sum(cells.power * np.abs(responses[k]) ** 2, axis=1))
        expected = np.real((responses[i] * cells.power) @ responses[j].conj().T)
        scale = np.outer(own[i], own[j])
        # measured 1e-7; rows and columns exchanged, or the other's place of the wrong sign: 0.06 to 1
        np.testing.assert_allclose(block / scale, expected / scale, rtol=0, atol=1e-5)
    # There is one beam for all: of several, that of the box would be meant.
    assert len(coupled.interaction.beams.images) == 1
    assert set(own) == set(range(10))


def test_executors_do_not_change_a_bit(coupled):
    for executor in (Threads(2), Copies(2)):
        again = couplings_of(coupled.fits, coupled.interaction, executor)
        np.testing.assert_array_equal(again.blocks, coupled.couplings.blocks)
        np.testing.assert_array_equal(again.first, coupled.couplings.first)
