"""Errors of a shape whose neighbours are not known exactly."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.neighbours import with_neighbours_marginalised

E = slice(1, 3)
STAYS = np.zeros(6)


def _matrix(seed, size=6):
    half = np.random.default_rng(seed).normal(size=(size, size))
    return half @ half.T + 0.1 * np.eye(size)


def _shape(covariance):
    return ShapeMeasurement(
        ellipticity=np.array([0.1, -0.2]),
        covariance=covariance,
        flux=1.0,
        flux_err=0.1,
        scale_length=2.0,
        scale_length_err=0.2,
        offset=np.zeros(2),
        offset_err=np.array([0.3, 0.4]),
        snr=10.0,
        best=None,
        flag=FitFlag.OK,
    )


seeds = st.integers(0, 9999)


@settings(deadline=None)
@given(seeds)
def test_a_posterior_as_wide_as_its_fisher_matrix_becomes_that_of_free_neighbours(seed):
    alone, free = _matrix(seed), _matrix(seed + 1)
    got = with_neighbours_marginalised(_shape(alone[E, E]), alone, free, STAYS)
    np.testing.assert_allclose(got.covariance, free[E, E], rtol=1e-6, atol=1e-9)


@settings(deadline=None)
@given(seeds)
def test_neighbours_that_add_nothing_change_nothing(seed):
    alone, posterior = _matrix(seed), _matrix(seed + 1, 2)
    got = with_neighbours_marginalised(_shape(posterior), alone, alone, STAYS)
    np.testing.assert_allclose(got.covariance, posterior, rtol=1e-7, atol=1e-10)
    assert got.flux_err == pytest.approx(0.1)
    assert got.scale_length_err == pytest.approx(0.2)
    np.testing.assert_allclose(got.offset_err, [0.3, 0.4])


@settings(deadline=None)
@given(seeds, st.floats(1.0, 9.0))
def test_every_error_grows_with_the_fisher_matrix(seed, factor):
    alone, posterior = _matrix(seed), _matrix(seed + 1, 2)
    got = with_neighbours_marginalised(_shape(posterior), alone, factor * alone, STAYS)
    np.testing.assert_allclose(got.covariance, factor * posterior, rtol=1e-7, atol=1e-10)
    grown = math.sqrt(factor)
    assert got.flux_err == pytest.approx(0.1 * grown)
    assert got.scale_length_err == pytest.approx(0.2 * grown)
    np.testing.assert_allclose(got.offset_err, np.array([0.3, 0.4]) * grown)
    assert got.e_sigma == pytest.approx(_shape(posterior).e_sigma * grown, rel=1e-6)


@settings(deadline=None)
@given(seeds)
def test_the_area_of_the_ellipse_grows_by_that_of_the_fisher_matrices(seed):
    alone, free, posterior = _matrix(seed), _matrix(seed + 1), _matrix(seed + 2, 2)
    got = with_neighbours_marginalised(_shape(posterior), alone, free, STAYS).covariance
    ratio = np.linalg.det(free[E, E]) / np.linalg.det(alone[E, E])
    np.testing.assert_allclose(got, got.T, rtol=1e-9, atol=1e-12)
    assert np.linalg.det(got) == pytest.approx(np.linalg.det(posterior) * ratio, rel=1e-6)


def test_each_error_grows_by_its_own_parameter():
    alone, free = np.eye(6), np.diag([4.0, 1.0, 1.0, 9.0, 16.0, 25.0])
    got = with_neighbours_marginalised(_shape(np.eye(2)), alone, free, STAYS)
    assert got.flux_err == pytest.approx(0.2)
    assert got.scale_length_err == pytest.approx(0.6)
    np.testing.assert_allclose(got.offset_err, [1.2, 2.0])


def test_what_is_measured_stays():
    before = _shape(np.eye(2))
    after = with_neighbours_marginalised(before, np.eye(6), 4 * np.eye(6), STAYS)
    np.testing.assert_array_equal(after.ellipticity, before.ellipticity)
    assert (after.flux, after.scale_length, after.snr, after.flag) == (
        before.flux,
        before.scale_length,
        before.snr,
        before.flag,
    )


def test_a_failure_stays_a_failure():
    failed = ShapeMeasurement.failed(FitFlag.NO_PEAK)
    assert with_neighbours_marginalised(failed, np.eye(6), 2 * np.eye(6), STAYS) is failed


def test_the_mean_follows_a_shift_as_far_as_the_posterior_is_the_likelihoods():
    shift = np.array([9.0, 0.02, -0.01, 9.0, 9.0, 9.0])
    before = _shape(0.01 * np.eye(2))
    half = with_neighbours_marginalised(before, 0.02 * np.eye(6), 0.02 * np.eye(6), shift)
    np.testing.assert_allclose(half.ellipticity - before.ellipticity, [0.01, -0.005])


def test_a_shift_of_half_the_error_ends_there():
    before = _shape(np.diag([0.04, 0.01]))
    after = with_neighbours_marginalised(
        before, np.eye(6) / 25, np.eye(6) / 25, np.array([0, 30.0, 0, 0, 0, 0])
    )
    np.testing.assert_allclose(after.ellipticity - before.ellipticity, [0.5 * 0.2, 0.0])


def test_what_the_posterior_has_counted_widens_no_more():
    before = _shape(np.diag([0.04, 0.01]))
    after = with_neighbours_marginalised(
        before, np.eye(6), 1.25 * np.eye(6), STAYS, information_fraction=0.8
    )
    np.testing.assert_allclose(after.covariance, before.covariance)
