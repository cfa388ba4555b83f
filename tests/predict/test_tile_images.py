"""The image of a tile against the sum over its galaxies."""

import numpy as np
import pytest

from tests.skies import galaxies
from uvshear.constants import ARCSEC, SPEED_OF_LIGHT
from uvshear.galaxy import Exponential, Gaussian
from uvshear.imaging.bands import Band
from uvshear.predict import predict_visibilities
from uvshear.predict.tile_images import draw_tile

FREQUENCY = np.array([1.1e9, 1.4e9])


@pytest.mark.parametrize("profile", [Exponential(), Gaussian()])
def test_the_visibilities_of_a_tile_are_the_sum_over_its_galaxies(profile):
    rng = np.random.default_rng(8)
    l, m = 0.2 + rng.uniform(-0.0005, 0.0005, 30), -0.1 + rng.uniform(-0.0005, 0.0005, 30)
    e = 0.5 * np.exp(2j * np.pi * rng.uniform(size=30))
    alpha, flux = rng.uniform(0.2, 1, 30) * ARCSEC, rng.uniform(1, 2, 30)
    sky = galaxies(l=l, m=m, flux=flux, e=e, alpha=alpha, beta=0.0)
    uvw = rng.uniform(-1, 1, (400, 3)) * np.array([2e3, 2e3, 4e2])
    longest = 1.1 * float(np.hypot(*uvw[:, :2].T).max()) * FREQUENCY.max() / SPEED_OF_LIGHT
    spectrum = np.array([1.0, 0.6])
    tile = draw_tile(sky, sky.flux, spectrum, Band(0.0, longest, 1 / (2.8 * longest)), profile)
    expected = predict_visibilities(sky, uvw, FREQUENCY, profile) * spectrum
    error = np.abs(tile.visibilities(uvw, FREQUENCY) - expected)
    # measured 2e-6: the second order of w over a galaxy, which the sum does not have
    assert np.sqrt(np.mean(error**2)) < 1e-5 * np.sqrt(np.sum(sky.flux**2))


def test_baselines_beyond_the_band_are_not_represented():
    sky = galaxies(alpha=1e-9)
    tile = draw_tile(sky, sky.flux, np.ones(2), Band(0.0, 1e3, 1 / 2.8e3), Exponential())
    uvw = np.array([[1e3, 0, 0], [1.3e3, 0, 0]]) * SPEED_OF_LIGHT / FREQUENCY[0]
    seen = np.abs(tile.visibilities(uvw, FREQUENCY)[:, 0])
    assert seen[0] == pytest.approx(1, abs=1e-5)
    assert seen[1] < 0.5
