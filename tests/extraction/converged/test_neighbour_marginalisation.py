"""Free neighbours against the inverse of the Fisher matrix of all parameters."""

import numpy as np
import pytest

from tests.extraction.converged.coupled_galaxies import coupled_galaxies
from tests.extraction.converged.fisher_matrices import SIX, fisher_matrix, parts_of
from uvshear.extraction.converged.couplings import CouplingBlocks
from uvshear.extraction.converged.neighbour_marginalisation import marginalise_neighbours
from uvshear.shapes.normal_equations import NormalEquations


@pytest.fixture(scope="module")
def coupled():
    return coupled_galaxies()


NO_PRIOR = (np.zeros(SIX), np.zeros(SIX))


def _marginalised(equations, couplings, source, others, sky_prior=NO_PRIOR):
    blocks = CouplingBlocks(couplings, np.ones(len(equations)))
    return marginalise_neighbours(source, others, equations, blocks, sky_prior)


@pytest.mark.parametrize("source", [0, 3])
def test_the_covariance_with_free_neighbours_is_that_of_the_inverse_of_the_wholefisher_matrix(
    source,
):
    pairs = [(i, j) for i in range(4) for j in range(i + 1, 4)]
    matrix = fisher_matrix(4)
    equations, couplings, _ = parts_of(matrix, pairs)
    others = [k for k in (3, 1, 0, 2) if k != source]
    got = _marginalised(equations, couplings, source, others)
    rows = slice(SIX * source, SIX * (source + 1))
    expected = np.linalg.inv(matrix)[rows, rows]
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(got.marginal / scale, expected / scale, rtol=0, atol=1e-8)
    alone = np.linalg.inv(equations[source].information)
    np.testing.assert_allclose(got.conditional / scale, alone / scale, rtol=0, atol=1e-8)
    np.testing.assert_array_equal(got.shift, 0)
    # free neighbours take information away, never give any
    assert np.linalg.eigvalsh((got.marginal - got.conditional) / scale).min() > -1e-9
    assert np.diag(got.marginal / got.conditional).max() > 1.2


def test_a_source_takes_back_what_neighbours_had_while_its_prior_held_it():
    """For a quadratic likelihood: without the prior, neighbours free, against neighbours where the sky has them."""
    pairs = [(i, j) for i in range(3) for j in range(i + 1, 3)]
    matrix = fisher_matrix(3)
    scale = np.sqrt(np.diag(matrix))
    right = matrix @ (np.random.default_rng(4).normal(size=len(matrix)) / scale)
    precision = 0.7 * np.diag(matrix)[:SIX]
    sky = matrix + np.diag(np.concatenate([precision, np.zeros(2 * SIX)]))
    settled = np.linalg.solve(sky, right)
    without = np.linalg.solve(matrix, right)[:SIX]
    own, others = matrix[:SIX, :SIX], matrix[:SIX, SIX:]
    neighbours_fixed = np.linalg.solve(own, right[:SIX] - others @ settled[SIX:])

    equations, _, _ = parts_of(sky, pairs)
    _, couplings, _ = parts_of(matrix, pairs)
    got = _marginalised(equations, couplings, 0, [2, 1], (-precision * settled[:SIX], precision))
    expected = (without - neighbours_fixed) * scale[:SIX]
    assert np.abs(expected).max() > 0.1
    np.testing.assert_allclose(got.shift * scale[:SIX], expected, rtol=0, atol=1e-6)


def test_neighbours_that_are_not_coupled_change_nothing():
    equations, couplings, _ = parts_of(fisher_matrix(5), [(1, 2)])
    got = _marginalised(equations, couplings, 0, [3, 4])
    scale = np.sqrt(np.outer(np.diag(got.conditional), np.diag(got.conditional)))
    np.testing.assert_allclose(got.marginal / scale, got.conditional / scale, rtol=0, atol=1e-9)


def test_an_own_block_below_that_of_the_shared_baselines_is_raised_to_it(coupled):
    """Facets and the shared beam differ by a little: no eigenvalue below zero, no error out of hand."""
    own = coupled.couplings.own[:2]
    equations = [NormalEquations(np.zeros(SIX), 0.8 * own[k]) for k in range(2)]
    blocks = CouplingBlocks(coupled.couplings, coupled.couplings.flux)
    got = marginalise_neighbours(0, [1], equations, blocks, NO_PRIOR)
    whole = np.block([[own[0], blocks.between(0, 1)], [blocks.between(1, 0), own[1]]])
    expected = np.linalg.inv(whole)[:SIX, :SIX]
    np.testing.assert_allclose(np.diag(got.marginal), np.diag(expected), rtol=1e-2)
    assert np.linalg.eigvalsh(whole / np.sqrt(np.outer(*2 * [np.diag(whole)]))).min() > 1e-3
