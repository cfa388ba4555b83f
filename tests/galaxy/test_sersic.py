"""Profiles without a closed transform against GalSim."""

import galsim
import numpy as np
import pytest

from uvshear.galaxy import DiscBulge, Exponential, Gaussian, Sersic
from uvshear.galaxy.sersic import HALF_LIGHT

Q = np.logspace(-5, 4, 60)
ACCURATE = galsim.GSParams(kvalue_accuracy=1e-9, folding_threshold=1e-4, maximum_fft_size=2**15)


def test_index_one_is_the_exponential_disc():
    np.testing.assert_allclose(Sersic(1.0).envelope(Q), Exponential().envelope(Q), atol=1e-8)


@pytest.mark.parametrize(("index", "error"), [(2.0, 1e-5), (4.0, 3e-5)])
def test_the_transform_is_galsims(index, error):
    """GalSim's own table is off by that for large q; ours is right to 1e-8 for n = 1."""
    galaxy = galsim.Sersic(index, half_light_radius=HALF_LIGHT, gsparams=ACCURATE)
    expected = [galaxy.kValue(k, 0).real for k in np.sqrt(Q)]
    np.testing.assert_allclose(Sersic(index).envelope(Q), expected, atol=error)


def test_a_disc_with_a_bulge_is_the_sum_of_the_two():
    disc = galsim.Exponential(scale_radius=1.0)
    bulge = galsim.Sersic(4.0, half_light_radius=0.5 * HALF_LIGHT, gsparams=ACCURATE)
    galaxy = 0.8 * disc + 0.2 * bulge
    expected = [galaxy.kValue(k, 0).real for k in np.sqrt(Q)]
    np.testing.assert_allclose(DiscBulge(0.2, 0.5).envelope(Q), expected, atol=1e-5)


@pytest.mark.parametrize("profile", [Sersic(2.0), DiscBulge()])
def test_single_precision_stays_single(profile):
    q = Q.astype(np.float32)
    assert profile.envelope(q).dtype == np.float32
    np.testing.assert_allclose(profile.envelope(q), profile.envelope(Q), atol=2e-6)


def test_all_profiles_hold_half_of_the_light_within_one_radius_but_the_gaussian():
    """The Gaussian's scale is its sigma; the others share the disc's half-light radius."""
    near = 1e-3
    for profile in (Sersic(2.0), DiscBulge(0.2, 1.0)):
        assert profile.envelope(np.array([near]))[0] < Exponential().envelope(np.array([near]))[0]
    assert Gaussian().envelope(np.array([near]))[0] == pytest.approx(1 - near / 2, rel=1e-6)
