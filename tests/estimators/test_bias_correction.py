"""A simulated bias taken out of a shear."""

import numpy as np
import pytest

from uvshear.estimators.bias_correction import BiasCorrection, Component
from uvshear.estimators.shear_estimate import ShearEstimate


def test_the_bias_is_taken_out_and_its_errors_are_in():
    first, second = Component(-0.1, 0.01, 2e-3, 1e-3), Component(0.05, 0.0, 0.0, 0.0)
    measured = ShearEstimate(0.9 * 0.03 + 2e-3, 4e-3, 1.05 * -0.02, 5e-3, 100, "mean")
    known = BiasCorrection((first, second), {"10-20 uJy": (first, second)}, "mean", 10.0)
    got = known.applied(measured)
    assert known.applied_by_flux({"10-20 uJy": measured, "20-50 uJy": measured}) == {
        "10-20 uJy": got
    }
    assert got.g1 == pytest.approx(0.03)
    assert got.g2 == pytest.approx(-0.02)
    # (4e-3)^2 + (1e-3)^2 + (0.03 x 0.01)^2, over 0.9
    assert got.g1_err == pytest.approx(np.sqrt(4e-3**2 + 1e-3**2 + 3e-4**2) / 0.9)
    assert got.g2_err == pytest.approx(5e-3 / 1.05)
    assert (got.n, got.estimator, got.frame) == (100, "mean", "sky")


def test_errors_of_a_correction_are_those_of_draws():
    """Linear in small errors: the scatter of corrected shears when m, c and the shear scatter."""
    rng = np.random.default_rng(1)
    m, c = -0.1 + 0.01 * rng.normal(size=100_000), 1e-3 * rng.normal(size=100_000)
    measured = 0.045 + 2e-3 * rng.normal(size=100_000)
    _, error = Component(-0.1, 0.01, 0.0, 1e-3).corrected(0.045, 2e-3)
    assert error == pytest.approx(np.std((measured - c) / (1 + m)), rel=0.02)
