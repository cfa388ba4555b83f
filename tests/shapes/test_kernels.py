"""Kernels of the fits against numpy, in both precisions where they have two."""

import numpy as np
import pytest

from uvshear.shapes import kernels

RNG = np.random.default_rng(2)
X, Y = RNG.uniform(-1, 1, (2, 700))
REAL, IMAGINARY = RNG.normal(size=(2, 700))
FORM = np.array([2.0, -0.5, 1.5])


@pytest.mark.parametrize(("dtype", "allowed"), [(np.float32, 1e-6), (np.float64, 1e-14)])
def test_quadratic_forms_are_evaluated_in_the_dtype_of_the_cells(dtype, allowed):
    x, y = X.astype(dtype), Y.astype(dtype)
    expected = 2.0 * X * X - 0.5 * X * Y + 1.5 * Y * Y
    q = np.empty_like(x)
    kernels.quadratic(x, y, FORM, q)
    np.testing.assert_allclose(q, expected, rtol=0, atol=3 * allowed)
    several = np.empty((2, len(x)), dtype)
    kernels.quadratics(x, y, np.stack([FORM, 2 * FORM]), several)
    np.testing.assert_allclose(several, [expected, 2 * expected], rtol=0, atol=6 * allowed)


def test_norms_are_added_to():
    envelopes, power = RNG.uniform(size=(3, 700)), RNG.uniform(size=700)
    norms = np.ones(3)
    kernels.add_norms(envelopes, power, norms)
    np.testing.assert_allclose(norms, 1 + (envelopes**2) @ power, rtol=1e-12)


@pytest.mark.parametrize(
    ("kernel", "allowed"), [(kernels.displace, 1e-12), (kernels.displace_single, 2e-6)]
)
def test_a_displacement_brings_what_stood_at_the_shift_to_the_centre(kernel, allowed):
    shift = np.array([3.0, -7.0])
    source = np.exp(1j * (X * shift[0] + Y * shift[1]))
    real, imaginary = np.empty((2, len(X)))
    kernel(X, Y, *shift, source.real.copy(), source.imag.copy(), real, imaginary)
    np.testing.assert_allclose(real + 1j * imaginary, 1.0, rtol=0, atol=allowed)


def test_displaced_sums_are_those_of_what_is_displaced():
    shift = (0.7, -1.3)
    source = RNG.normal(size=len(X)) + 1j * RNG.normal(size=len(X))
    parts = source.real.copy(), source.imag.copy()
    real, imaginary = np.empty((2, len(X)))
    kernels.displace(X, Y, *shift, *parts, real, imaginary)
    expected = real.sum(), imaginary @ X, imaginary @ Y
    np.testing.assert_allclose(kernels.displaced_sums(X, Y, *shift, *parts), expected, rtol=1e-11)


def test_phases_turn_by_the_position():
    uv = 1e5 * np.column_stack([X, Y])
    phase = np.empty(len(uv), np.complex64)
    kernels.turn(uv, 2e-6, -3e-6, phase)
    expected = np.exp(2j * np.pi * (uv[:, 0] * 2e-6 - uv[:, 1] * 3e-6))
    np.testing.assert_allclose(phase, expected, rtol=0, atol=1e-6)


def test_responses_are_derivatives_of_the_product():
    uv = np.column_stack([X, Y])
    q = np.empty(len(uv))
    kernels.argument(uv, FORM, q)
    np.testing.assert_allclose(q, 2.0 * X * X - 0.5 * X * Y + 1.5 * Y * Y, atol=1e-14)
    phase = np.exp(2j * np.pi * (0.3 * X + 0.1 * Y))
    by_shape = RNG.normal(size=(3, 3))
    out = np.empty((6, len(uv)), complex)
    kernels.respond(uv, phase, np.exp(-q), -np.exp(-q), by_shape, 2.0, out)
    np.testing.assert_allclose(out[0], np.exp(-q) * phase, atol=1e-14)
    for row, derivative in enumerate(by_shape):
        by_q = derivative[0] * X * X + derivative[1] * X * Y + derivative[2] * Y * Y
        np.testing.assert_allclose(out[1 + row], -2.0 * np.exp(-q) * by_q * phase, atol=1e-13)
    np.testing.assert_allclose(out[4], 4j * np.pi * X * np.exp(-q) * phase, atol=1e-13)
    np.testing.assert_allclose(out[5], 4j * np.pi * Y * np.exp(-q) * phase, atol=1e-13)


def test_normal_sums_over_several_blocks_are_those_of_numpy():
    """The order of the sums is what ``NormalSums`` reads; its test is ``test_normal_sums``."""
    envelope, slope, power = RNG.uniform(size=(3, 700))
    forms = RNG.normal(size=(3, 3))
    sums = np.full(19, 9.0)
    kernels.normal_sums(envelope, slope, X, Y, forms, REAL, IMAGINARY, power, sums)
    squares = np.stack([X * X, X * Y, Y * Y])
    responses = np.vstack([envelope, slope * (forms @ squares)])
    gram = (responses * power) @ responses.T
    expected = np.concatenate(
        [
            responses @ REAL,
            gram[np.triu_indices(4)],
            np.stack([X, Y]) @ (IMAGINARY * envelope),
            squares @ (power * envelope**2),
        ]
    )
    np.testing.assert_allclose(sums, expected, rtol=1e-11)
