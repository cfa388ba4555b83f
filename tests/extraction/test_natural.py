import numpy as np

from tests.extraction.sources import PROFILE, part
from tests.reference import direct_sum
from tests.skies import galaxies, random_baselines
from uvshear.constants import ARCSEC
from uvshear.extraction.natural import natural_norms
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet


def test_natural_norms_are_sums_over_every_visibility_for_unit_flux():
    frequency = np.array([1.3e9, 1.5e9])
    uvw = random_baselines(60, 4e3, depth=0.0)
    weights = np.random.default_rng(2).uniform(0, 2, (60, 2))
    seen = Visibilities(uvw, frequency, np.zeros((60, 2), complex), weights)
    chunks = tuple(part(seen, rows) for rows in np.array_split(np.arange(60), 3))
    observation = VisibilitySet(PhaseCentre(0.0, 0.0), chunks)
    e = np.array([0.3 + 0.2j, 0j])
    sky = galaxies(0.0, 0.0, [2e-5, 7e-5], [3 * ARCSEC, 0.0], e, beta=0.0)
    norms = natural_norms(observation, sky, PROFILE)
    extended = direct_sum.galaxy(0, 0, 1.0, e[0], 3 * ARCSEC, uvw, frequency)
    np.testing.assert_allclose(
        norms, [np.sum(weights * np.abs(extended) ** 2), weights.sum()], rtol=1e-9
    )
