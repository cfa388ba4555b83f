import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.reference import likelihood
from tests.shapes.facets import ALPHA, EXPONENTIAL, GAUSSIAN, samples
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import LARGEST_ELLIPTICITY, Template, difference, moved

PROFILES = {"exponential": EXPONENTIAL, "gaussian": GAUSSIAN}
PLACE = (3.1 * ALPHA, -4.3 * ALPHA)
FIT = GalaxyFit(2.0, np.array([0.4, -0.2]) * ALPHA, 0.3 - 0.4j, 1.2 * ALPHA, 50.0)


def _theta(fit):
    e = fit.ellipticity
    return np.array([fit.flux, e.real, e.imag, math.log(fit.scale_length), *fit.offset])


@pytest.mark.parametrize("kind", PROFILES)
def test_the_model_is_the_galaxy_displaced_by_its_place_and_its_own_offset(kind):
    uv, _ = samples(200)
    expected = likelihood.galaxy(uv, _theta(FIT), PLACE, kind)
    got = Template(uv, PROFILES[kind], PLACE).model(FIT)
    # measured 1e-7; the place left out: 2
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-6 * FIT.flux)


@pytest.mark.parametrize("kind", PROFILES)
def test_responses_are_the_models_derivatives(kind):
    uv, _ = samples(200)
    expected = likelihood.derivatives(
        lambda theta: likelihood.galaxy(uv, theta, PLACE, kind), _theta(FIT)
    )
    got = Template(uv, PROFILES[kind], PLACE).responses(FIT)
    for row, truth in zip(got, expected, strict=True):
        # measured 1e-7; a sign: 2; the flux left out: 0.5
        assert np.linalg.norm(row - truth) < 1e-6 * np.linalg.norm(truth)


def test_a_point_source_responds_to_its_flux_and_place_alone():
    uv, _ = samples(200)
    fit = GalaxyFit(2.0, np.array([0.4, -0.2]) * ALPHA, 0j, 0.0, 50.0)
    responses = Template(uv, EXPONENTIAL, PLACE).responses(fit)
    phase = np.exp(2j * np.pi * uv @ (np.array(PLACE) + fit.offset))
    np.testing.assert_array_equal(responses[1:4], 0)
    np.testing.assert_allclose(responses[0], phase, rtol=0, atol=2e-6)
    for axis in (0, 1):
        expected = 2j * np.pi * 2.0 * uv[:, axis] * phase
        np.testing.assert_allclose(
            responses[4 + axis], expected, rtol=0, atol=2e-6 * np.abs(expected).max()
        )


steps = st.tuples(*[st.floats(-0.3, 0.3)] * 6).map(
    lambda x: np.array(x) * (1, 1, 1, 1, ALPHA, ALPHA)
)


@settings(deadline=None)
@given(steps)
def test_the_difference_of_a_galaxy_moved_is_the_step(step):
    new = moved(FIT, step)
    np.testing.assert_allclose(
        difference(new, FIT) / (1, 1, 1, 1, ALPHA, ALPHA),
        step / (1, 1, 1, 1, ALPHA, ALPHA),
        rtol=0,
        atol=1e-12,
    )
    assert new.snr == FIT.snr


@settings(deadline=None)
@given(steps)
def test_moving_by_the_difference_leads_from_one_galaxy_to_the_other(step):
    new = moved(FIT, step)
    again = moved(FIT, difference(new, FIT))
    np.testing.assert_allclose(_theta(again), _theta(new), rtol=1e-12, atol=1e-18)


@settings(deadline=None)
@given(st.floats(-5, 5), st.floats(-5, 5))
def test_no_step_leaves_the_disc_of_ellipticities(e1, e2):
    new = moved(FIT, np.array([0, e1, e2, 0, 0, 0]))
    assert abs(new.ellipticity) <= LARGEST_ELLIPTICITY * (1 + 1e-12)
    wanted = FIT.ellipticity + complex(e1, e2)
    assert abs(wanted) * new.ellipticity == pytest.approx(abs(new.ellipticity) * wanted)


@pytest.mark.parametrize("sign", [-1, 1])
def test_no_step_more_than_doubles_or_halves_the_size(sign):
    new = moved(FIT, np.array([0, 0, 0, 30.0 * sign, 0, 0]))
    assert math.log(new.scale_length / FIT.scale_length) == pytest.approx(0.7 * sign)


def test_the_size_of_a_point_source_does_not_change():
    point = GalaxyFit(1.0, np.zeros(2), 0j, 0.0, 5.0)
    new = moved(point, np.array([0.5, 0, 0, 0.3, ALPHA, 0]))
    assert new.scale_length == 0
    np.testing.assert_allclose(difference(new, point), [0.5, 0, 0, 0, ALPHA, 0], rtol=1e-15)
