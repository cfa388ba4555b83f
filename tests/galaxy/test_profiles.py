from dataclasses import FrozenInstanceError

import galsim
import numpy as np
import pytest

from tests.galaxy.profile_battery import (
    check_galsim,
    check_profile,
    galsim_transform,
    transform,
)
from uvshear.galaxy import Exponential, Gaussian, Profile
from uvshear.geometry.ellipticity import add_shear, sheared_scale_length

EXACT = galsim.GSParams(kvalue_accuracy=1e-16, maxk_threshold=1e-12)
REFERENCES = [
    (Exponential(), lambda radius: galsim.Exponential(scale_radius=radius, gsparams=EXACT)),
    (Gaussian(), lambda radius: galsim.Gaussian(sigma=radius, gsparams=EXACT)),
]
BY_NAME = pytest.mark.parametrize(
    ("profile", "circular"), REFERENCES, ids=lambda x: type(x).__name__
)


class OneLine(Profile):
    def envelope(self, q):
        return (1 + q) ** -2


@pytest.mark.parametrize("profile", [Exponential(), Gaussian()], ids=lambda p: type(p).__name__)
def test_a_profile_passes_the_battery(profile):
    check_profile(profile)


def test_a_profile_of_ones_own_is_one_line():
    q = np.linspace(0, 9, 50)
    slope = OneLine().envelope_slope(q)
    np.testing.assert_allclose(slope[1:], -2 * (1 + q[1:]) ** -3, rtol=1e-6)
    assert abs(slope[0] + 2) < 1e-3  # one-sided at 0


@BY_NAME
def test_galsim_has_the_same_transform(profile, circular):
    check_galsim(profile, circular)


@BY_NAME
@pytest.mark.parametrize("g", [0.05 + 0j, 0.05j, -0.2 + 0.3j])
def test_shear_is_the_map_galsim_makes(profile, circular, g):
    uv = np.random.default_rng(2).uniform(-0.6, 0.6, (2, 60))
    scale_length = np.array([0.7])
    for e in (0j, 0.4 + 0j, 0.2 - 0.5j):
        galaxy = circular(0.7 / np.sqrt(1 - abs(e) ** 2)).shear(g1=e.real, g2=e.imag)
        sheared = add_shear(np.array([e]), g)
        alpha = sheared_scale_length(scale_length, np.array([e]), sheared)[0]
        got = transform(profile, sheared[0], alpha, uv)
        expected = galsim_transform(galaxy.shear(g1=g.real, g2=g.imag), uv)
        np.testing.assert_allclose(got, expected, atol=1e-10)  # at fixed alpha: 1e-2


@BY_NAME
def test_magnification_multiplies_scale_length_and_flux_as_galsim_lenses(profile, circular):
    uv = np.random.default_rng(4).uniform(-0.6, 0.6, (2, 60))
    e, g, mu = np.array([0.3 - 0.2j]), 0.1 + 0.05j, 1.3
    galaxy = circular(0.7 / np.sqrt(1 - abs(e[0]) ** 2)).shear(g1=e[0].real, g2=e[0].imag)
    sheared = add_shear(e, g)
    alpha = sheared_scale_length(np.array([0.7]), e, sheared)[0] * np.sqrt(mu)
    expected = galsim_transform(galaxy.lens(g1=g.real, g2=g.imag, mu=mu), uv)
    np.testing.assert_allclose(mu * transform(profile, sheared[0], alpha, uv), expected, atol=1e-10)


def test_a_profile_is_immutable():
    with pytest.raises(FrozenInstanceError):
        Exponential().scale = 1.0


@pytest.mark.parametrize("profile", [Exponential(), Gaussian()])
def test_an_array_of_any_shape_keeps_it(profile):
    q = np.linspace(0, 3, 12)
    for function in (profile.envelope, profile.envelope_slope):
        np.testing.assert_array_equal(function(q.reshape(3, 4)), function(q).reshape(3, 4))
