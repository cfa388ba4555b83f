"""Kernels of the prediction against numpy."""

import numpy as np

from uvshear.predict import kernels

UVW = np.random.default_rng(3).uniform(-3e4, 3e4, (3, 50))
PER_METRE = 4.7
FORM = np.array([3e-12, 1e-12, 2e-12])


def test_the_argument_of_a_profile_is_a_form_of_the_shifted_baseline():
    q = np.empty(50)
    kernels.profile_argument(UVW, PER_METRE, 0.01, -0.02, FORM, q)
    u, v = PER_METRE * (UVW[0] - 0.01 * UVW[2]), PER_METRE * (UVW[1] + 0.02 * UVW[2])
    expected = 4 * np.pi**2 * (FORM[0] * u * u + FORM[1] * u * v + FORM[2] * v * v)
    np.testing.assert_allclose(q, expected, rtol=1e-11)


def test_a_source_is_added_with_its_phase():
    real, imaginary = np.ones(50), np.zeros(50)
    envelope = np.linspace(0, 1, 50)
    kernels.add_source(
        UVW, PER_METRE, np.array([1e-3, 2e-3, -3e-6]), 2.0, envelope, real, imaginary
    )
    turns = PER_METRE * (UVW.T @ np.array([1e-3, 2e-3, -3e-6]))
    expected = 1 + 2.0 * envelope * np.exp(2j * np.pi * turns)
    np.testing.assert_allclose(real + 1j * imaginary, expected, rtol=0, atol=1e-9)


def test_a_plane_has_the_form_the_taper_and_the_phases_of_its_axes():
    u, v = np.linspace(-1, 1, 6), np.linspace(0, 1, 4)
    q, spectrum = np.empty((6, 4)), np.empty((6, 4), complex)
    kernels.plane_argument(u, v, np.array([2.0, -0.5, 1.5]), q)
    expected = 2 * u[:, None] ** 2 - 0.5 * u[:, None] * v + 1.5 * v**2
    np.testing.assert_allclose(q, expected, atol=1e-14)
    taper, along_u, along_v = np.full((6, 4), 0.5), np.exp(1j * u), np.exp(2j * v)
    kernels.plane_spectrum(np.exp(-q), taper, along_u, along_v, spectrum)
    np.testing.assert_allclose(spectrum, 0.5 * np.exp(-q) * along_u[:, None] * along_v, atol=1e-14)
