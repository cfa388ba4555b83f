"""Slopes by the definitions that the documentation quotes (``benchmarks/slopes.py``)."""

import numpy as np
import pytest
from benchmarks.slopes import paper_slope, slope_figures


def test_the_papers_slope_has_the_scatter_that_its_formal_error_says():
    rng = np.random.default_rng(1)
    true = rng.normal(0, 0.27, 400)
    error = rng.uniform(0.02, 0.3, 400)
    slopes = [
        paper_slope(true, 0.95 * true + error * rng.normal(size=400), error) for _ in range(500)
    ]
    values = np.array([slope.value for slope in slopes])
    assert values.mean() == pytest.approx(0.95, abs=4 * slopes[0].error / np.sqrt(500))
    assert values.std() == pytest.approx(slopes[0].error, rel=0.12)


def test_the_effective_number_of_galaxies_is_that_of_the_bright_ones():
    """Three galaxies with a hundredth of the error of a thousand others carry the slope."""
    true, error = np.full(1003, 0.2), np.full(1003, 1.0)
    error[:3] = 0.01
    assert paper_slope(true, true, error).effective == pytest.approx(3.2, abs=0.1)


def test_galaxies_without_a_shape_are_left_out_and_bins_are_by_flux():
    rng = np.random.default_rng(2)
    true = rng.normal(0, 0.2, 60) + 1j * rng.normal(0, 0.2, 60)
    measured = true.copy()
    flux = np.repeat([15.0, 30.0, 100.0], 20)
    measured[flux < 20] *= 0.5
    measured[0] = np.nan
    figures = slope_figures(true, measured, np.full((60, 2), 0.1), flux)
    assert figures["slope_10_20_e1"] == pytest.approx(0.5)
    assert figures["slope_50_200_e2"] == pytest.approx(1.0)
    assert 0.5 < figures["slope_unweighted_e1"] < 1
    assert {"slope_e1_err", "slope_population_e2", "effective_galaxies_e1"} <= set(figures)
