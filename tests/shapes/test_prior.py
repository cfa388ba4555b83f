import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.reference import likelihood
from tests.shapes.facets import ALPHA
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior

PRIOR = ShapePrior(
    math.log(ALPHA),
    0.3,
    ellipticity_sigma=0.25,
    position_sigma=0.5 * ALPHA,
    flux=1.5,
    flux_sigma=0.6,
)
thetas = st.tuples(
    st.floats(0.2, 4.0), *[st.floats(-0.6, 0.6)] * 3, *[st.floats(-1.0, 1.0)] * 2
).map(lambda x: np.array(x) * (1, 1, 1, 1, ALPHA, ALPHA) + (0, 0, 0, math.log(ALPHA), 0, 0))


def _fit(theta):
    flux, e1, e2, log_alpha, l, m = (float(x) for x in theta)
    return GalaxyFit(flux, np.array([l, m]), complex(e1, e2), math.exp(log_alpha), 1.0)


@settings(deadline=None)
@given(thetas)
def test_the_penalty_is_minus_twice_the_logarithm_of_the_density(theta):
    flux, e1, e2, log_alpha, l, m = theta
    expected = ((flux - 1.5) / 0.6) ** 2
    expected += (e1**2 + e2**2) / 0.25**2
    expected += ((log_alpha - math.log(ALPHA)) / 0.3) ** 2
    expected += (l**2 + m**2) / (0.5 * ALPHA) ** 2
    assert PRIOR.penalty(_fit(theta)) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@settings(deadline=None)
@given(thetas)
def test_the_pull_is_minus_half_the_penaltys_gradient_and_the_precision_half_its_curvature(theta):
    def penalty(values):
        return PRIOR.penalty(_fit(values))

    pull, precision = PRIOR.pull(_fit(theta))
    scale = np.sqrt(precision)
    steps = likelihood.steps(theta)
    slope = likelihood.derivatives(penalty, theta)
    # the penalty is a quadratic: differences are exact but for rounding, measured 1e-9
    np.testing.assert_allclose(pull / scale, -0.5 * slope / scale, rtol=0, atol=1e-6)
    for k in range(6):
        step = np.zeros(6)
        step[k] = 30 * steps[k]
        second = penalty(theta + step) - 2 * penalty(theta) + penalty(theta - step)
        assert second / step[k] ** 2 / 2 == pytest.approx(precision[k], rel=1e-4)


def test_a_prior_that_is_not_given_neither_pulls_nor_penalises():
    prior = ShapePrior(math.log(ALPHA), 0.3)
    fit = _fit(np.array([3.0, 0.4, -0.5, math.log(ALPHA), ALPHA, -ALPHA]))
    assert prior.penalty(fit) == 0
    pull, precision = prior.pull(fit)
    np.testing.assert_array_equal(pull, 0)
    np.testing.assert_allclose(precision, [0, 0, 0, 0.3**-2, 0, 0], rtol=1e-12)


def test_the_shape_of_a_point_source_is_not_pulled_and_stands_for_itself():
    fit = GalaxyFit(1.2, np.array([0.3, -0.1]) * ALPHA, 0j, 0.0, 1.0)
    pull, precision = PRIOR.pull(fit)
    np.testing.assert_array_equal(pull[1:4], 0)
    np.testing.assert_array_equal(precision[1:4], 1)
    assert pull[0] == pytest.approx((1.5 - 1.2) / 0.6**2)
    assert pull[4] == pytest.approx(-0.3 * ALPHA / (0.5 * ALPHA) ** 2)
    expected = (0.3 / 0.6) ** 2 + (0.3**2 + 0.1**2) / 0.5**2
    assert PRIOR.penalty(fit) == pytest.approx(expected)


@settings(deadline=None)
@given(thetas, st.floats(1.1, 3.0))
def test_a_looser_prior_penalises_less(theta, factor):
    looser = replace(PRIOR, ellipticity_sigma=factor * 0.25, flux_sigma=factor * 0.6)
    assert looser.penalty(_fit(theta)) <= PRIOR.penalty(_fit(theta))
