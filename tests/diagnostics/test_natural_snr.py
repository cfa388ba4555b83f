from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.sources import PROFILE, part
from tests.reference import direct_sum
from tests.skies import galaxies, random_baselines
from uvshear.constants import ARCSEC
from uvshear.diagnostics.natural_snr import natural_norms, with_natural_snr
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.baseline_map import map_baselines
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement


@pytest.mark.parametrize("beta", [0.0, -0.8])
def test_natural_norms_are_sums_over_every_visibility_for_unit_flux(beta):
    frequency = np.array([1.3e9, 1.5e9])
    uvw = random_baselines(600, 2e4, depth=0.0)
    uvw[0] = 0.0, 0.0, 1.0
    weights = np.random.default_rng(2).uniform(0, 2, (600, 2))
    seen = Visibilities(uvw, frequency, np.zeros((600, 2), complex), weights)
    chunks = tuple(part(seen, rows) for rows in np.array_split(np.arange(600), 3))
    observation = VisibilitySet(PhaseCentre(0.0, 0.0), chunks)
    e = np.array([0.3 + 0.2j, -0.7 + 0.1j, 0j])
    size = np.array([3.0, 0.8, 0.0]) * ARCSEC
    sky = galaxies(0.0, 0.0, [2e-5, 3e-5, 7e-5], size, e, beta=beta)
    norms = natural_norms(map_baselines(observation), sky, PROFILE)
    gain = (frequency / sky.reference_frequency) ** beta
    expected = [
        np.sum(weights * np.abs(gain * direct_sum.galaxy(0, 0, 1.0, *shape, uvw, frequency)) ** 2)
        for shape in zip(e[:2], size[:2], strict=True)
    ]
    np.testing.assert_allclose(norms[:2], expected, rtol=1e-3)
    # Single precision, 1e-7 where processors take reciprocal roots by approximation; a cell has one frequency.
    exactly = 5e-7 if beta == 0 else 2e-3
    np.testing.assert_allclose(norms[2], np.sum(weights * gain**2), rtol=exactly)


def test_measurements_are_quoted_with_the_snr_of_all_baselines():
    uvw = random_baselines(600, 2e4, depth=0.0)
    frequency, weights = np.array([1.4e9]), np.full((600, 1), 1e8)
    seen = Visibilities(uvw, frequency, np.zeros((600, 1), complex), weights)
    cells = map_baselines(VisibilitySet(PhaseCentre(0.0, 0.0), (seen,)))
    sky = galaxies(0.0, 0.0, [2e-5, 3e-5], 2 * ARCSEC, 0j)
    failed = ShapeMeasurement.failed(FitFlag.NO_PEAK)
    measured = {1: replace(failed, flux=5e-5)}
    quoted = with_natural_snr(measured, cells, sky, PROFILE)
    norm = natural_norms(cells, sky.select(np.array([1])), PROFILE)[0]
    assert quoted[1].snr == pytest.approx(5e-5 * np.sqrt(norm))
    assert with_natural_snr({}, cells, sky, PROFILE) == {}
