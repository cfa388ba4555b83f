"""One step of all sources against the dense matrix of all their parameters."""

from dataclasses import replace

import numpy as np

from tests.extraction.converged.fisher_matrices import PAIRS, SIX, fisher_matrix, parts_of
from uvshear.extraction.converged.joint_step import DAMPING, solve_jointly


def test_the_step_is_that_of_the_damped_densefisher_matrix():
    equations, couplings, dense = parts_of(fisher_matrix(5), PAIRS)
    step = solve_jointly(equations, couplings, np.ones(5), np.zeros(5, bool))
    gradient = np.concatenate([source.gradient for source in equations])
    scale = np.sqrt(np.diag(dense))
    expected = np.linalg.solve(dense + DAMPING * np.diag(np.diag(dense)), gradient)
    # measured 9e-4, where conjugate gradients end; without the blocks 0.24, without far fluxes 0.05, undamped 0.3
    error = np.linalg.norm((step.ravel() - expected) * scale)
    assert error < 2e-3 * np.linalg.norm(expected * scale)


def test_fixed_sources_stay_and_the_others_move_as_if_they_were_known():
    equations, couplings, dense = parts_of(fisher_matrix(5), PAIRS)
    fixed = np.array([False, True, False, False, True])
    step = solve_jointly(equations, couplings, np.ones(5), fixed)
    free = np.repeat(~fixed, SIX)
    gradient = np.concatenate([source.gradient for source in equations])[free]
    scale = np.sqrt(np.diag(dense))
    damped = (dense + DAMPING * np.diag(np.diag(dense)))[np.ix_(free, free)]
    expected = np.linalg.solve(damped, gradient)
    assert np.abs(step.ravel() * scale)[~free].max() < 1e-6
    error = np.linalg.norm((step.ravel() * scale)[free] - expected * scale[free])
    assert error < 2e-3 * np.linalg.norm(expected * scale[free])


def test_a_system_without_a_solution_moves_no_source():
    """Filterwarnings are errors in tests: none of numpy's reaches the user either."""
    equations, couplings, _ = parts_of(fisher_matrix(5), PAIRS)
    huge = [replace(source, gradient=1e200 * source.gradient) for source in equations]
    step = solve_jointly(huge, couplings, np.ones(5), np.zeros(5, bool))
    np.testing.assert_array_equal(step, 0.0)
