import math

import numpy as np
import pytest

from uvshear.diagnostics.slope import fit_slope
from uvshear.reproduce.finding import Estimate, Quantity, signed


def test_a_pull_is_the_difference_over_its_error():
    quantity = Quantity("m", Estimate(0.1, 0.03), Estimate(0.2, 0.04))
    assert quantity.pull == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("paper", "ours"),
    [(None, Estimate(1.0, 0.1)), (Estimate(1.0, 0.1), None), (Estimate(1.0), Estimate(2.0))],
)
def test_without_both_numbers_or_any_error_there_is_no_pull(paper, ours):
    assert Quantity("m", paper, ours).pull is None


def test_the_error_of_a_slope_is_that_of_the_scatter():
    x = np.array([1.0, -1.0, 1.0, -1.0])
    slope = fit_slope(x, x + np.array([0.1, 0.1, -0.1, -0.1]), np.full(4, 0.5))
    assert Estimate.from_slope(slope) == Estimate(slope.value, slope.error)


def test_a_signed_number_has_a_minus_sign():
    assert signed(-0.01234) == "−0.0123"
    assert signed(0.5, 1) == "+0.5"


def test_the_error_of_a_modulus_is_that_along_the_number():
    modulus = Estimate.modulus(Estimate(0.03, 0.002), Estimate(-0.04, 0.001))
    assert modulus.value == pytest.approx(0.05)
    assert modulus.error == pytest.approx(math.hypot(0.6 * 0.002, 0.8 * 0.001))
    assert Estimate.modulus(Estimate(0.0, 0.1), Estimate(0.0)).value == 0
