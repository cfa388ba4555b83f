"""The fit from outside: what it flags, in which units it answers, and whether its errors are true."""

from dataclasses import replace

import numpy as np
import pytest

from tests.shapes.facets import ALPHA, EXPONENTIAL, PRIOR, noise_free, noisy
from uvshear.galaxy import DiscEllipticityPrior, FlatEllipticityPrior
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.shape import fit_galaxy, measure_shape


def test_a_facet_without_weight_is_flagged():
    empty = Facet(np.empty((0, 2)), np.empty(0, complex), np.empty(0))
    dark = Facet(np.ones((3, 2)), np.zeros(3, complex), np.zeros(3))
    for facet in (empty, dark):
        assert measure_shape(facet, PRIOR, EXPONENTIAL).flag is FitFlag.NO_DATA
        assert fit_galaxy(facet, PRIOR, EXPONENTIAL) is None


def test_a_negative_source_is_flagged():
    facet, _ = noise_free(0.2j, snr=50.0)
    negative = replace(facet, correlation=-facet.correlation)
    tight = replace(PRIOR, position_radius=0.1 * ALPHA)
    assert measure_shape(negative, tight, EXPONENTIAL).flag is FitFlag.NO_PEAK
    assert fit_galaxy(negative, tight, EXPONENTIAL) is None


def test_a_source_outside_the_prior_of_its_position_is_flagged():
    facet, _ = noise_free(0.2j, l=ALPHA, snr=50.0)
    shape = measure_shape(facet, replace(PRIOR, position_radius=0.2 * ALPHA), EXPONENTIAL)
    assert shape.flag is FitFlag.OFF_POSITION
    inside = measure_shape(facet, replace(PRIOR, position_radius=1.1 * ALPHA), EXPONENTIAL)
    assert inside.flag is FitFlag.OK


def test_a_failure_carries_no_numbers():
    failed = ShapeMeasurement.failed(FitFlag.NO_PEAK)
    numbers = [failed.ellipticity, failed.covariance, failed.flux, failed.snr, failed.offset_err]
    assert all(np.all(np.isnan(number)) for number in numbers)
    assert failed.best is None
    assert np.isnan(failed.e_sigma)


def test_a_flag_is_a_word_in_tables_and_a_sentence_for_people():
    assert FitFlag.OFF_POSITION.word == "off_position"
    assert len({flag.value for flag in FitFlag}) == len(FitFlag)


def test_what_comes_out_is_in_jansky_and_radians():
    l, m = 0.2 * ALPHA, -0.3 * ALPHA
    facet, galaxy = noise_free(0.3 + 0.1j, 1.1 * ALPHA, l, m, snr=500.0)
    shape = measure_shape(facet, PRIOR, EXPONENTIAL)
    assert shape.flag is FitFlag.OK
    assert shape.flux == pytest.approx(galaxy.flux[0], rel=3e-3)
    assert shape.scale_length == pytest.approx(1.1 * ALPHA, rel=3e-3)
    np.testing.assert_allclose(shape.offset, [l, m], rtol=0, atol=3e-3 * ALPHA)
    assert shape.snr == pytest.approx(500, rel=3e-3)
    assert shape.e_sigma == pytest.approx(np.linalg.det(shape.covariance) ** 0.25)


def test_a_turned_sky_has_turned_shapes():
    facet, _ = noisy(np.random.default_rng(6), 0.3 + 0.1j, snr=25.0)
    turned = replace(facet, uv=np.column_stack([-facet.uv[:, 1], facet.uv[:, 0]]))
    a, b = (measure_shape(f, PRIOR, EXPONENTIAL) for f in (facet, turned))
    # a quarter turn: e -> -e, the same posterior but for the lattice's place
    sigma = a.e_sigma
    np.testing.assert_allclose(b.ellipticity, -a.ellipticity, rtol=0, atol=5e-3 * sigma)
    np.testing.assert_allclose(b.covariance, a.covariance, rtol=0, atol=5e-3 * sigma**2)


def test_a_mirrored_sky_has_mirrored_shapes():
    facet, _ = noisy(np.random.default_rng(6), 0.3 + 0.1j, snr=25.0)
    mirrored = replace(facet, uv=facet.uv * (1, -1))
    a, b = (measure_shape(f, PRIOR, EXPONENTIAL) for f in (facet, mirrored))
    np.testing.assert_allclose(
        b.ellipticity, a.ellipticity * (1, -1), rtol=0, atol=5e-3 * a.e_sigma
    )


def _pulls(number):
    """(measured - true)/error of e1, e2, ln flux ..., galaxies of SNR 30 to 100 drawn from the priors."""
    rng = np.random.default_rng(20)
    modulus = DiscEllipticityPrior().draw_modulus(number, rng)
    e = modulus * np.exp(2j * np.pi * rng.uniform(size=number))
    snr = np.exp(rng.uniform(np.log(30), np.log(100), number))
    alpha = ALPHA * np.exp(PRIOR.log_scale_length_sigma * rng.normal(size=number))
    pulls = np.full((number, 5), np.nan)
    for k in range(number):
        l, m = rng.uniform(-0.3, 0.3, 2) * ALPHA
        facet, galaxy = noisy(rng, e[k], alpha[k], l, m, snr[k], number=300, seed=k)
        shape = measure_shape(facet, PRIOR, EXPONENTIAL)
        assert shape.flag is FitFlag.OK
        sigma = np.sqrt(np.diag(shape.covariance))
        pulls[k, :2] = (shape.ellipticity - [e[k].real, e[k].imag]) / sigma
        pulls[k, 2] = (shape.flux - galaxy.flux[0]) / shape.flux_err
        pulls[k, 3:] = (shape.offset - [l, m]) / shape.offset_err
    return pulls


def test_pulls_are_of_width_one():
    number = 320
    pulls = _pulls(number)
    for values in (pulls[:, :2], pulls[:, 2:3], pulls[:, 3:]):
        width, error = values.std(), 1 / np.sqrt(2 * values.size)
        assert error < 0.041
        assert 0.9 < width < 1.1  # measured 1.03, 0.96, 1.01
        assert abs(values.mean()) < 3 / np.sqrt(values.size)  # measured 0.75, 1.0, 1.1 of its error


def test_one_baseline_does_not_determine_a_shape():
    """The Fisher matrix of the position has no second dimension; unguarded, its Cholesky factor fails."""
    uv = np.array([[2e4, 1e4]])
    facet = Facet(uv, np.array([1e8 + 0j]), np.array([1e12]))
    assert measure_shape(facet, PRIOR, EXPONENTIAL).flag is FitFlag.UNDETERMINED
    assert fit_galaxy(facet, PRIOR, EXPONENTIAL) is None


@pytest.mark.parametrize("prior", [FlatEllipticityPrior(0.5), DiscEllipticityPrior()])
def test_a_prior_narrower_than_the_galaxy_is_elliptical_holds(prior):
    """The best fit lies outside the prior, where a lattice that began there would have no point."""
    facet, _ = noise_free(0.88 + 0j, snr=60.0)
    shape = measure_shape(facet, replace(PRIOR, ellipticity=prior), EXPONENTIAL)
    assert np.hypot(*shape.ellipticity) < prior.maximum
    assert shape.ellipticity[0] > 0.9 * prior.maximum - 0.1


def test_a_posterior_much_wider_than_its_fisher_matrix_is_covered():
    """An unresolved galaxy: nothing is known of e, whatever the curvature at the best fit."""
    facet, _ = noise_free(0.3j, alpha=ALPHA / 100, snr=100.0, reach=0.3)
    tiny = replace(
        PRIOR, log_scale_length=PRIOR.log_scale_length - np.log(100), log_scale_length_sigma=0.01
    )
    shape = measure_shape(facet, tiny, EXPONENTIAL)
    assert shape.flag in {FitFlag.OK, FitFlag.NOT_CONVERGED}
    assert shape.e_sigma > 0.2


def test_cells_without_power_do_no_harm():
    """Truncation leaves cells of power below zero under a uv range: broad templates have no norm there."""
    rng = np.random.default_rng(3)
    facet, _ = noisy(rng, 0.2j, snr=20.0)
    spilt = replace(facet, power=np.where(np.arange(600) % 3 == 0, -0.2, 1.0) * facet.power)
    shape = measure_shape(spilt, PRIOR, EXPONENTIAL)
    assert np.all(np.isfinite(shape.ellipticity)) or shape.flag is not FitFlag.OK


@pytest.mark.parametrize("seed", [19, 26, 30])
def test_a_posterior_narrower_than_the_data_can_make_it_is_not_believed(seed):
    """Noise thirty times what the weights claim: a bump of it in the likelihood, 0.13 to 0.39 of the Fisher error."""
    facet, _ = noise_free(0.3 + 0.1j, snr=30.0)
    noise = np.random.default_rng(seed).normal(size=(2, len(facet.power)))
    wild = 30 * np.sqrt(facet.power) * (noise[0] + 1j * noise[1])
    shape = measure_shape(replace(facet, correlation=facet.correlation + wild), PRIOR, EXPONENTIAL)
    assert shape.flag is FitFlag.UNRELIABLE
    assert shape.best is None
    assert np.all(np.isfinite(shape.ellipticity))
