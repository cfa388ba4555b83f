"""Slopes by the definitions that the documentation quotes (``benchmarks/slopes.py``)."""

import numpy as np
import pytest
from benchmarks.slopes import slope_figures


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
