import numpy as np
import pytest

from uvshear.galaxy import DiscEllipticityPrior, FlatEllipticityPrior
from uvshear.shapes.weight import lensfit_weight

POPULATION = DiscEllipticityPrior()


def test_the_weight_is_the_design_formula():
    s = np.array([0.03, 0.1, 0.3])
    largest, variance = 0.804, POPULATION.population_variance
    expected = 1 / (s**2 * largest**2 / (largest**2 - 2 * s**2) + variance)
    np.testing.assert_allclose(lensfit_weight(s, POPULATION), expected, rtol=1e-12)


def test_a_perfect_measurement_has_the_inverse_variance_of_the_population():
    moduli = POPULATION.draw_modulus(200_000, np.random.default_rng(1))
    weight = lensfit_weight(np.array([0.0]), POPULATION)[0]
    # half the mean square of |e|: 200 000 draws give it to 0.3 per cent; the whole: a factor 2
    assert weight == pytest.approx(2 / np.mean(moduli**2), rel=0.01)


def test_a_measurement_that_says_nothing_has_no_weight():
    largest = POPULATION.maximum
    s = np.array([0.999, 1.001, 1.2, 50.0]) * largest / np.sqrt(2)
    weight = lensfit_weight(s, POPULATION)
    assert 0 < weight[0] < 0.02
    assert weight[1:].tolist() == [0, 0, 0]


def test_weights_fall_with_the_error():
    s = np.linspace(0, 0.56, 50)
    for population in (POPULATION, FlatEllipticityPrior()):
        assert np.all(np.diff(lensfit_weight(s, population)) < 0)


def test_a_failed_measurement_has_weight_zero_and_no_warning():
    weight = lensfit_weight(np.array([np.nan, np.inf, 0.1]), POPULATION)
    assert weight[:2].tolist() == [0, 0]
    assert weight[2] > 0
