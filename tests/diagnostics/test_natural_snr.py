import numpy as np
import pytest

from tests.extraction.sources import PROFILE, part
from tests.reference import direct_sum
from tests.skies import galaxies, random_baselines
from uvshear.constants import ARCSEC
from uvshear.diagnostics.natural_norms import natural_norms
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet


@pytest.mark.parametrize("beta", [0.0, -0.8])
def test_natural_norms_are_sums_over_every_visibility_for_unit_flux(beta):
    frequency = np.array([1.3e9, 1.5e9])
    uvw = random_baselines(600, 2e4, depth=0.0)
    uvw[0] = 0.0
    weights = np.random.default_rng(2).uniform(0, 2, (600, 2))
    seen = Visibilities(uvw, frequency, np.zeros((600, 2), complex), weights)
    chunks = tuple(part(seen, rows) for rows in np.array_split(np.arange(600), 3))
    observation = VisibilitySet(PhaseCentre(0.0, 0.0), chunks)
    e = np.array([0.3 + 0.2j, -0.7 + 0.1j, 0j])
    size = np.array([3.0, 0.8, 0.0]) * ARCSEC
    sky = galaxies(0.0, 0.0, [2e-5, 3e-5, 7e-5], size, e, beta=beta)
    norms = natural_norms(observation, sky, PROFILE)
    gain = (frequency / sky.reference_frequency) ** beta
    expected = [
        np.sum(weights * np.abs(gain * direct_sum.galaxy(0, 0, 1.0, *one, uvw, frequency)) ** 2)
        for one in zip(e[:2], size[:2], strict=True)
    ]
    np.testing.assert_allclose(norms[:2], expected, rtol=1e-3)
    # Single precision, 1e-7 where processors take reciprocal roots by approximation; a cell has one frequency.
    exactly = 5e-7 if beta == 0 else 2e-3
    np.testing.assert_allclose(norms[2], np.sum(weights * gain**2), rtol=exactly)
