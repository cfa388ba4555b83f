import numpy as np
import pytest

from uvshear.diagnostics.slope import fit_slope
from uvshear.errors import InputError


def test_an_exact_line_has_its_slope_and_no_error() -> None:
    true = np.array([-0.3, 0.1, 0.5])
    slope = fit_slope(true, 0.95 * true, np.array([0.1, 0.2, 0.3]))
    assert slope.value == pytest.approx(0.95, rel=1e-14)
    assert slope.error < 1e-14


def test_noisy_galaxies_weigh_less_by_the_design_formula() -> None:
    true, measured = np.array([0.2, 0.2]), np.array([0.2, 0.1])
    error = np.array([0.1, 0.5])
    w = 1 / (error**2 + 0.07)
    assert fit_slope(true, measured, error).value == pytest.approx((w[0] + w[1] / 2) / w.sum())
    assert fit_slope(true, measured).value == pytest.approx(0.75)


def test_the_error_is_the_scatter_over_many_draws() -> None:
    rng = np.random.default_rng(4)
    true = rng.normal(0, 0.25, 200)
    error = rng.uniform(0.02, 0.3, 200)
    fits = [fit_slope(true, 0.9 * true + error * rng.normal(size=200), error) for _ in range(400)]
    scatter = np.std([fit.value for fit in fits])
    quoted = np.mean([fit.error for fit in fits])
    assert quoted == pytest.approx(scatter, rel=0.1)  # 400 draws: 3.5 per cent; measured 1


def test_flagged_galaxies_are_left_out() -> None:
    true = np.array([0.1, 0.2, 0.3])
    assert fit_slope(true, np.array([0.1, np.nan, 0.3])).value == pytest.approx(1)


def test_a_slope_needs_two_galaxies() -> None:
    with pytest.raises(InputError, match="two or more"):
        fit_slope(np.array([0.1]), np.array([0.1]))
