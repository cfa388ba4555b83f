import galsim
import numpy as np
import pytest

from tests.galaxy.profile_battery import galsim_transform, transform
from uvshear.constants import ARCMIN
from uvshear.errors import InputError
from uvshear.galaxy import Exponential
from uvshear.simulation.lensing import shear_at_fixed_scale_length, shear_galaxies
from uvshear.simulation.population import Population, draw_population
from uvshear.simulation.sky_region import SquareField

EXACT = galsim.GSParams(kvalue_accuracy=1e-16)


@pytest.fixture
def galaxies():
    return draw_population(
        Population(ring=10), SquareField(30 * ARCMIN), number=40, rng=np.random.default_rng(1)
    )


@pytest.mark.parametrize("g", [0.04 + 0j, 0.03j, -0.2 + 0.1j])
def test_sheared_galaxies_are_galsims(galaxies, g):
    uv = np.random.default_rng(2).uniform(-5e4, 5e4, (2, 20))
    sheared = shear_galaxies(galaxies, g)
    for i, e in enumerate(galaxies.ellipticity):
        radius = galaxies.scale_length[i] / np.sqrt(1 - abs(e) ** 2)
        reference = galsim.Exponential(scale_radius=radius, gsparams=EXACT)
        reference = reference.shear(g1=e.real, g2=e.imag).shear(g1=g.real, g2=g.imag)
        got = transform(Exponential(), sheared.ellipticity[i], sheared.scale_length[i], uv)
        np.testing.assert_allclose(got, galsim_transform(reference, uv), atol=1e-10)


def test_shear_is_undone_by_its_opposite_and_leaves_the_rest(galaxies):
    g = 0.05 * np.exp(1j * np.arange(40))  # one a galaxy
    back = shear_galaxies(shear_galaxies(galaxies, g), -g)
    np.testing.assert_allclose(back.ellipticity, galaxies.ellipticity, atol=1e-14)
    np.testing.assert_allclose(back.scale_length, galaxies.scale_length, rtol=1e-14)
    sheared = shear_galaxies(galaxies, g)
    for name in ("l", "m", "flux", "spectral_index"):
        np.testing.assert_array_equal(getattr(sheared, name), getattr(galaxies, name))


def test_the_legacy_mode_changes_ellipticity_alone(galaxies):
    g = 0.04 + 0.02j
    legacy, true = shear_at_fixed_scale_length(galaxies, g), shear_galaxies(galaxies, g)
    np.testing.assert_array_equal(legacy.ellipticity, true.ellipticity)
    np.testing.assert_array_equal(legacy.scale_length, galaxies.scale_length)
    assert np.abs(true.scale_length / galaxies.scale_length - 1).max() > 0.02


def test_the_mean_of_a_sheared_ring_is_the_shear(galaxies):
    # over all orientations the mean of e is g exactly; ten of them leave terms of order g^9
    g = 0.04 * np.exp(0.7j)
    rings = shear_galaxies(galaxies, g).ellipticity.reshape(-1, 10)
    np.testing.assert_allclose(rings.mean(axis=1), g, atol=1e-12)


@pytest.mark.parametrize("shear", [shear_galaxies, shear_at_fixed_scale_length])
def test_a_strong_lens_is_refused(galaxies, shear):
    with pytest.raises(InputError, match="reduced shear"):
        shear(galaxies, 1.0 + 0j)
