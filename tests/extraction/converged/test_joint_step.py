"""One step of all sources against the dense matrix of all their parameters."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy import sparse

from tests.extraction.converged.major_cycles import GRIDDING, LONGEST, PROFILE
from tests.reference import likelihood
from tests.skies import L_BAND, galaxies, vla
from uvshear.constants import ARCSEC
from uvshear.extraction.converged.beams import Beams, gather_beams
from uvshear.extraction.converged.interaction import Interaction
from uvshear.extraction.converged.joint_step import (
    DAMPING,
    BlockOf,
    Couplings,
    couple,
    freedom,
    joint_step,
)
from uvshear.extraction.converged.plan import Wanted, plan_visit
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict.response import Response
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.normal_equations import NormalEquations

SIX = 6
SCALES = np.array([1e-6, 0.05, 0.05, 0.1, 1e-7, 1e-7])
"""Errors of parameters as they come: flux [Jy], shape, position [rad]."""


def _matrix(sources, seed=1, coupled=0.8):
    """Fisher matrix of all parameters, positive, with blocks and far fluxes; in the units of ``SCALES``."""
    rng = np.random.default_rng(seed)
    size = sources * SIX
    half = rng.normal(size=(size, 3 * size)) / np.sqrt(3 * size)
    correlated = half @ half.T
    matrix = coupled * correlated + (1 - coupled) * np.kron(np.eye(sources), np.eye(SIX))
    scale = np.tile(SCALES, sources) * np.repeat(rng.uniform(0.3, 3, sources), SIX)
    return matrix / np.outer(scale, scale)


def _parts(matrix, pairs, seed=2):
    """The matrix as the package holds it: own blocks, pairs, far fluxes; and the dense matrix of these alone."""
    sources = len(matrix) // SIX
    rng = np.random.default_rng(seed)
    blocks = matrix.reshape(sources, SIX, sources, SIX)
    equations = [
        NormalEquations(
            rng.normal(size=SIX) * np.sqrt(np.diag(blocks[k, :, k, :])), blocks[k, :, k, :]
        )
        for k in range(sources)
    ]
    dense = np.zeros_like(blocks)
    for k in range(sources):
        dense[k, :, k, :] = blocks[k, :, k, :]
    for i, j in pairs:
        dense[i, :, j, :], dense[j, :, i, :] = blocks[i, :, j, :], blocks[j, :, i, :]
    errors = np.sqrt([blocks[k, 0, k, 0] for k in range(sources)])
    far = 0.2 * rng.uniform(size=(sources, sources)) * np.outer(errors, errors)
    far = np.triu(far, 1) + np.triu(far, 1).T
    for i in range(sources):
        dense[i, 0, :, 0] += far[i]
    first, second = np.array(pairs).T
    held = np.array([blocks[i, :, j, :] for i, j in pairs])
    shared = np.array([0.9 * blocks[k, :, k, :] for k in range(sources)])
    couplings = Couplings(first, second, held, shared, sparse.csr_matrix(far), np.ones(sources))
    return equations, couplings, dense.reshape(matrix.shape)


PAIRS = [(0, 1), (0, 3), (1, 2), (2, 4), (3, 4)]


def test_the_step_is_that_of_the_damped_dense_matrix():
    equations, couplings, dense = _parts(_matrix(5), PAIRS)
    step = joint_step(equations, couplings, np.ones(5), np.zeros(5, bool))
    gradient = np.concatenate([one.gradient for one in equations])
    scale = np.sqrt(np.diag(dense))
    expected = np.linalg.solve(dense + DAMPING * np.diag(np.diag(dense)), gradient)
    # measured 9e-4, where conjugate gradients end; without the blocks 0.24, without far fluxes 0.05, undamped 0.3
    error = np.linalg.norm((step.ravel() - expected) * scale)
    assert error < 2e-3 * np.linalg.norm(expected * scale)


def test_sources_held_stay_and_the_others_move_as_if_they_were_known():
    equations, couplings, dense = _parts(_matrix(5), PAIRS)
    held = np.array([False, True, False, False, True])
    step = joint_step(equations, couplings, np.ones(5), held)
    free = np.repeat(~held, SIX)
    gradient = np.concatenate([one.gradient for one in equations])[free]
    scale = np.sqrt(np.diag(dense))
    damped = (dense + DAMPING * np.diag(np.diag(dense)))[np.ix_(free, free)]
    expected = np.linalg.solve(damped, gradient)
    assert np.abs(step.ravel() * scale)[~free].max() < 1e-6
    error = np.linalg.norm((step.ravel() * scale)[free] - expected * scale[free])
    assert error < 2e-3 * np.linalg.norm(expected * scale[free])


def test_blocks_grow_with_the_fluxes_since_they_were_worked_out():
    """All responses but that to the flux itself are proportional to the flux."""
    equations, couplings, _ = _parts(_matrix(5), PAIRS)
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
    _, couplings, _ = _parts(_matrix(5), PAIRS)
    got = couplings.at_flux(np.array([1.0, gone, 1.0, 1.0, 1.0]))
    assert np.all(np.isfinite(got))
    np.testing.assert_array_equal(got, couplings.blocks)


def test_the_sparse_matrix_is_the_dense_one():
    equations, couplings, dense = _parts(_matrix(5), PAIRS)
    scale = np.sqrt(np.diag(dense)).reshape(5, SIX)
    own = np.array([one.information for one in equations]) / (scale[:, :, None] * scale[:, None])
    got = couplings.blocks_with_diagonal(own, scale, np.ones(5)).toarray()
    for i in range(5):
        dense[SIX * i, ::SIX] -= couplings.far.toarray()[i]
    expected = dense / np.outer(scale.ravel(), scale.ravel())
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12)


NO_PRIOR = (np.zeros(SIX), np.zeros(SIX))


def _freedom(equations, couplings, source, others, sky_prior=NO_PRIOR):
    block_of = BlockOf(couplings, np.ones(len(equations)))
    return freedom(source, others, dict(enumerate(equations)), block_of, sky_prior)


@pytest.mark.parametrize("source", [0, 3])
def test_the_covariance_with_free_neighbours_is_that_of_the_inverse_of_the_whole_matrix(source):
    pairs = [(i, j) for i in range(4) for j in range(i + 1, 4)]
    matrix = _matrix(4)
    equations, couplings, _ = _parts(matrix, pairs)
    others = [k for k in (3, 1, 0, 2) if k != source]
    got = _freedom(equations, couplings, source, others)
    rows = slice(SIX * source, SIX * (source + 1))
    expected = np.linalg.inv(matrix)[rows, rows]
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(got.free / scale, expected / scale, rtol=0, atol=1e-8)
    alone = np.linalg.inv(equations[source].information)
    np.testing.assert_allclose(got.held / scale, alone / scale, rtol=0, atol=1e-8)
    np.testing.assert_array_equal(got.shift, 0)
    # free neighbours take information away, never give any
    assert np.linalg.eigvalsh((got.free - got.held) / scale).min() > -1e-9
    assert np.diag(got.free / got.held).max() > 1.2


def test_a_source_takes_back_what_neighbours_had_while_its_prior_held_it():
    """For a quadratic likelihood: without the prior, neighbours free, against neighbours where the sky has them."""
    pairs = [(i, j) for i in range(3) for j in range(i + 1, 3)]
    matrix = _matrix(3)
    scale = np.sqrt(np.diag(matrix))
    right = matrix @ (np.random.default_rng(4).normal(size=len(matrix)) / scale)
    precision = 0.7 * np.diag(matrix)[:SIX]
    sky = matrix + np.diag(np.concatenate([precision, np.zeros(2 * SIX)]))
    settled = np.linalg.solve(sky, right)
    without = np.linalg.solve(matrix, right)[:SIX]
    own, others = matrix[:SIX, :SIX], matrix[:SIX, SIX:]
    neighbours_held = np.linalg.solve(own, right[:SIX] - others @ settled[SIX:])

    equations, _, _ = _parts(sky, pairs)
    _, couplings, _ = _parts(matrix, pairs)
    got = _freedom(equations, couplings, 0, [2, 1], (-precision * settled[:SIX], precision))
    expected = (without - neighbours_held) * scale[:SIX]
    assert np.abs(expected).max() > 0.1
    np.testing.assert_allclose(got.shift * scale[:SIX], expected, rtol=0, atol=1e-6)


def test_neighbours_that_are_not_coupled_change_nothing():
    equations, couplings, _ = _parts(_matrix(5), [(1, 2)])
    got = _freedom(equations, couplings, 0, [3, 4])
    scale = np.sqrt(np.outer(np.diag(got.held), np.diag(got.held)))
    np.testing.assert_allclose(got.free / scale, got.held / scale, rtol=0, atol=1e-9)


def test_an_own_block_below_that_of_the_shared_baselines_is_raised_to_it(coupled):
    """Facets and the shared beam differ by a little: no eigenvalue below zero, no error out of hand."""
    own = coupled.couplings.own[:2]
    equations = {k: NormalEquations(np.zeros(SIX), 0.8 * own[k]) for k in range(2)}
    block_of = BlockOf(coupled.couplings, coupled.couplings.flux)
    got = freedom(0, [1], equations, block_of, NO_PRIOR)
    whole = np.block([[own[0], block_of(0, 1)], [block_of(1, 0), own[1]]])
    expected = np.linalg.inv(whole)[:SIX, :SIX]
    np.testing.assert_allclose(np.diag(got.free), np.diag(expected), rtol=1e-2)
    assert np.linalg.eigvalsh(whole / np.sqrt(np.outer(*2 * [np.diag(whole)]))).min() > 1e-3


def test_a_block_is_found_from_either_side():
    _, couplings, _ = _parts(_matrix(5), PAIRS)
    block_of = BlockOf(couplings, np.ones(5))
    np.testing.assert_array_equal(block_of(1, 2), couplings.blocks[2])
    np.testing.assert_array_equal(block_of(2, 1), couplings.blocks[2].T)
    assert block_of(0, 2) is None


@dataclass(frozen=True)
class Coupled:
    """Ten galaxies over 17 arcmin before a VLA, and what they have to do with one another."""

    place: np.ndarray
    fits: list[GalaxyFit]
    beams: Beams
    interaction: Interaction
    couplings: Couplings


@pytest.fixture(scope="module")
def coupled():
    rng = np.random.default_rng(7)
    lm = rng.uniform(-500, 500, (10, 2)) * ARCSEC
    lm[1] = lm[0] + np.array([8, -5]) * ARCSEC
    lm[2] = lm[0] + np.array([-30, 50]) * ARCSEC
    lm[3:5] = np.array([[-10, 20], [30, -25]]) * ARCSEC  # in squares that touch at a corner
    sky = galaxies(*lm.T, rng.uniform(0.3, 2, 10), 4 * ARCSEC, 0.2 - 0.1j)
    uvw, centre = vla("b", samples=4)
    vis = np.zeros((len(uvw), 1), complex)
    observation = VisibilitySet(centre, (Visibilities(uvw, L_BAND, vis, np.ones(vis.shape)),))
    plan = plan_visit(Wanted(*lm.T, np.full(10, 120 * ARCSEC), np.full(10, LONGEST)), 0.0, LONGEST)
    beams = gather_beams(observation, lm, (0.0, LONGEST), plan.pixel, Response.from_sky(sky), GRIDDING)
    interaction = Interaction(plan, beams, PROFILE)
    fits = [GalaxyFit(float(flux), np.zeros(2), 0.2 - 0.1j, 4 * ARCSEC, 10.0) for flux in sky.flux]
    return Coupled(lm, fits, beams, interaction, couple(lm, fits, beams, interaction, PROFILE, 1))


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
        cells = coupled.interaction.short_plane(int(coupled.beams.nearest[i]))
        responses = {
            k: _responses(cells.uv, thetas[k], coupled.place[k] - coupled.place[i]) for k in (i, j)
        }
        for k in (i, j):
            own[k] = np.sqrt(np.sum(cells.power * np.abs(responses[k]) ** 2, axis=1))
        expected = np.real((responses[i] * cells.power) @ responses[j].conj().T)
        scale = np.outer(own[i], own[j])
        # measured 1e-7; rows and columns exchanged, or the other's place of the wrong sign: 0.06 to 1
        np.testing.assert_allclose(block / scale, expected / scale, rtol=0, atol=1e-5)
    assert (
        len(coupled.beams.images) == 1
    )  # one beam for all: of several, that of the box would be meant
    assert set(own) == set(range(10))


def test_threads_do_not_change_a_bit(coupled):
    again = couple(coupled.place, coupled.fits, coupled.beams, coupled.interaction, PROFILE, 2)
    np.testing.assert_array_equal(again.blocks, coupled.couplings.blocks)
    np.testing.assert_array_equal(again.first, coupled.couplings.first)
