"""Normal equations and fisher_blocks against differences of the likelihood and sums over cells."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.reference import likelihood
from tests.shapes.facets import ALPHA, EXPONENTIAL, PRIOR, samples
from uvshear.interferometer.facet import BeamPlane, Facet
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.normal_equations import fisher_blocks, normal_equations, real_product

TIGHT = replace(
    PRIOR, ellipticity_sigma=0.25, position_sigma=0.5 * ALPHA, flux=1.2e-6, flux_sigma=5e-7
)
THETAS = np.array(
    [
        [1e-6, 0.3, -0.2, math.log(ALPHA), 0.2 * ALPHA, 0.1 * ALPHA],
        [7e-7, -0.1, 0.4, math.log(1.3 * ALPHA), -0.1 * ALPHA, 0.3 * ALPHA],
        [4e-7, 0.5, 0.1, math.log(0.8 * ALPHA), 0.0, -0.2 * ALPHA],
    ]
)
PLACES = [(0.0, 0.0), (3 * ALPHA, -1 * ALPHA), (-2 * ALPHA, 6 * ALPHA)]


def _fit(theta):
    flux, e1, e2, log_alpha, l, m = (float(x) for x in theta)
    return GalaxyFit(flux, np.array([l, m]), complex(e1, e2), math.exp(log_alpha), 1.0)


def _scaled(block, first, second):
    """A block in units of the errors of its rows and columns."""
    return block / np.outer(np.sqrt(np.diag(first)), np.sqrt(np.diag(second)))


def _direct_block(uv, power, i, j):
    responses = [
        likelihood.derivatives(
            lambda theta, k=k: likelihood.galaxy(uv, theta, PLACES[k]), THETAS[k]
        )
        for k in (i, j)
    ]
    return np.real(np.einsum("ak,bk,k->ab", responses[0], responses[1].conj(), power))


def test_fisher_blocks_are_sums_of_products_of_the_galaxies_derivatives():
    uv, power = samples()
    fits = [_fit(theta) for theta in THETAS]
    blocks = fisher_blocks(PLACES, fits, EXPONENTIAL, BeamPlane(uv, power), 2)
    assert blocks.shape == (2, 6, 3, 6)
    own = [_direct_block(uv, power, k, k) for k in range(3)]
    for i in range(2):
        for j in range(3):
            got = _scaled(blocks[i, :, j, :], own[i], own[j])
            expected = _scaled(_direct_block(uv, power, i, j), own[i], own[j])
            # measured 2e-7 of 1; places left out, or of opposite sign: 0.5
            np.testing.assert_allclose(got, expected, rtol=0, atol=2e-6)


def test_blocks_of_two_sources_are_one_anothers_transposes():
    uv, power = samples()
    fits = [_fit(theta) for theta in THETAS]
    blocks = fisher_blocks(PLACES, fits, EXPONENTIAL, BeamPlane(uv, power), 3)
    flat = blocks.reshape(18, 18)
    scale = np.sqrt(np.diag(flat))
    np.testing.assert_allclose(
        flat / np.outer(scale, scale), flat.T / np.outer(scale, scale), rtol=0, atol=1e-5
    )
    assert np.linalg.eigvalsh(flat / np.outer(scale, scale)).min() > 0


def test_the_gradient_is_that_of_the_log_posterior():
    """Everything is subtracted from the data but a part of the source that the present fit does not know."""
    uv, power = samples()
    theta = THETAS[0]
    truth = theta + np.array([1e-7, 0.1, -0.05, 0.1, 0.1 * ALPHA, -0.1 * ALPHA])
    correlation = power * likelihood.galaxy(uv, truth)
    residual = Facet(uv, correlation - power * likelihood.galaxy(uv, theta), power)

    def log_posterior(values):
        data = likelihood.log_likelihood(uv, correlation, power, [values], [(0.0, 0.0)])
        return data - 0.5 * TIGHT.penalty(_fit(values))

    expected = likelihood.derivatives(log_posterior, theta)
    equations = normal_equations(residual, TIGHT, EXPONENTIAL, _fit(theta))
    errors = np.sqrt(np.diag(equations.information))
    # measured 5e-8 of an error; the prior left out: 0.1
    np.testing.assert_allclose(equations.gradient / errors, expected / errors, rtol=0, atol=1e-6)
    assert np.abs(expected / errors).max() > 0.5


def test_the_information_is_the_curvature_at_the_best_fit():
    uv, power = samples()
    theta = THETAS[0]
    flat = replace(TIGHT, log_scale_length=theta[3], flux=theta[0])

    def gradient(values):
        left = power * (likelihood.galaxy(uv, theta) - likelihood.galaxy(uv, values))
        return normal_equations(Facet(uv, left, power), flat, EXPONENTIAL, _fit(values)).gradient

    information = normal_equations(
        Facet(uv, 0 * power.astype(complex), power), flat, EXPONENTIAL, _fit(theta)
    ).information
    curvature = np.array(
        [
            (gradient(theta + step) - gradient(theta - step)) / (2 * step[k])
            for k, step in enumerate(np.diag(10 * likelihood.steps(theta)))
        ]
    )
    scale = np.sqrt(np.diag(information))
    # measured 3e-6; the prior left out of the information: 0.1
    np.testing.assert_allclose(
        -curvature / np.outer(scale, scale),
        information / np.outer(scale, scale),
        rtol=0,
        atol=2e-5,
    )


def test_a_real_product_is_the_real_part_of_the_sum_with_the_second_conjugated():
    rng = np.random.default_rng(1)
    a, b = (
        (rng.normal(size=(k, 50)) + 1j * rng.normal(size=(k, 50))).astype(np.complex64)
        for k in (3, 4)
    )
    np.testing.assert_allclose(real_product(a, b), (a @ b.conj().T).real, rtol=0, atol=1e-4)
    assert real_product(1j * a, a)[0, 0] == pytest.approx(0.0, abs=1e-4)
