import numpy as np
import pytest

from uvshear.diagnostics.slope import (
    POPULATION_VARIANCE,
    equal_weights,
    fit_slope,
    fit_slopes,
    inverse_variance_weights,
    population_weights,
)
from uvshear.errors import InputError

WEIGHTINGS = pytest.mark.parametrize(
    "weighting", [inverse_variance_weights, population_weights, equal_weights]
)


@WEIGHTINGS
def test_an_exact_line_has_its_slope_and_no_scatter(weighting) -> None:
    true = np.array([-0.3, 0.1, 0.5])
    slope = fit_slope(true, 0.95 * true, np.array([0.1, 0.2, 0.3]), weighting)
    assert slope.value == pytest.approx(0.95, rel=1e-14)
    assert slope.error < 1e-14


def test_noisy_galaxies_weigh_less_by_the_formula_of_each_weighting() -> None:
    true, measured, error = np.array([0.2, 0.2]), np.array([0.2, 0.1]), np.array([0.1, 0.5])
    for w, weighting in (
        (1 / error**2, inverse_variance_weights),
        (1 / (error**2 + 0.07), population_weights),
        (np.ones(2), equal_weights),
    ):
        expected = (w[0] + w[1] / 2) / w.sum()
        assert fit_slope(true, measured, error, weighting).value == pytest.approx(expected)
    assert POPULATION_VARIANCE == 0.07


def test_the_weights_of_the_paper_are_the_default() -> None:
    true, measured, error = np.array([0.2, 0.2]), np.array([0.2, 0.1]), np.array([0.1, 0.5])
    default = fit_slope(true, measured, error)
    assert default == fit_slope(true, measured, error, inverse_variance_weights)
    # its formal error is 1/sqrt(sum x^2/s^2)
    assert default.formal_error == pytest.approx(1 / np.sqrt(np.sum(true**2 / error**2)))


@WEIGHTINGS
def test_the_errors_are_the_scatter_over_many_draws(weighting) -> None:
    rng = np.random.default_rng(4)
    true = rng.normal(0, 0.25, 200)
    error = rng.uniform(0.02, 0.3, 200)
    fits = [
        fit_slope(true, 0.9 * true + error * rng.normal(size=200), error, weighting)
        for _ in range(400)
    ]
    scatter = np.std([fit.value for fit in fits])
    # 400 draws: 3.5 per cent; measured 1 for 1/(s^2 + 0.07)
    assert fits[0].formal_error == pytest.approx(scatter, rel=0.1)
    # With weights 1/s^2 few galaxies count, 26 of 200, and the error from their scatter is as much too small.
    few = 1 / fits[0].effective_number
    assert np.mean([fit.error for fit in fits]) == pytest.approx(scatter, rel=0.1 + few)


def test_galaxies_of_equal_leverage_all_count_and_one_that_dominates_counts_alone() -> None:
    true = np.array([0.2, -0.2, 0.2, -0.2])
    alike = fit_slope(true, true, np.full(4, 0.1))
    assert alike.effective_number == pytest.approx(4)
    apart = fit_slope(true, true, np.array([1e-3, 1.0, 1.0, 1.0]))
    assert apart.effective_number == pytest.approx(1, abs=1e-4)


def test_flagged_galaxies_are_left_out() -> None:
    true, error = np.array([0.1, 0.2, 0.3]), np.full(3, 0.1)
    assert fit_slope(true, np.array([0.1, np.nan, 0.3]), error).value == pytest.approx(1)
    unknown = np.array([0.1, np.nan, 0.1])
    assert fit_slope(true, 2 * true, unknown).value == pytest.approx(2)


def test_three_weightings_at_once_are_those_one_by_one() -> None:
    rng = np.random.default_rng(1)
    true, error = rng.normal(0, 0.2, 50), rng.uniform(0.02, 0.3, 50)
    measured = true + error * rng.normal(size=50)
    slopes = fit_slopes(true, measured, error)
    assert slopes.inverse_variance == fit_slope(true, measured, error, inverse_variance_weights)
    assert slopes.population == fit_slope(true, measured, error, population_weights)
    assert slopes.unweighted == fit_slope(true, measured, error, equal_weights)


def test_shapes_pulled_towards_zero_where_they_are_noisy_have_a_higher_slope_with_the_paper_s_weights() -> (
    None
):
    """A posterior mean under a flat prior: e times a factor that falls with its error."""
    rng = np.random.default_rng(2)
    true, error = rng.normal(0, 0.25, 3000), 10 ** rng.uniform(-2, -0.5, 3000)
    slopes = fit_slopes(
        true, true / (1 + 4 * error**2) + 0.5 * error * rng.normal(size=3000), error
    )
    assert slopes.inverse_variance.value > slopes.population.value > slopes.unweighted.value
    assert slopes.inverse_variance.effective_number < slopes.unweighted.effective_number


def test_a_slope_needs_two_galaxies() -> None:
    with pytest.raises(InputError, match="two or more"):
        fit_slope(np.array([0.1]), np.array([0.1]), np.array([0.1]))
