"""Smeared galaxies against averages over finer channels and times, and what smearing does to ellipticities."""

import numpy as np
import pytest

from tests.skies import galaxies
from uvshear.constants import ARCSEC
from uvshear.execution import in_threads
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.attenuation import BandwidthSmearing, CombinedAttenuation, TimeSmearing
from uvshear.interferometer.coverage import EARTH_ROTATION, antenna_uvw
from uvshear.interferometer.primary_beam import AiryBeam
from uvshear.interferometer.visibilities import Integrations
from uvshear.predict import predict_visibilities
from uvshear.predict.losses import Losses

CENTRE = PhaseCentre(0.0, np.radians(-30.0))
FREQUENCY, WIDTH = np.array([1.05e9, 1.06e9]), np.array([1e6, 2e6])
HOURS = np.array([-0.7, 0.1, 0.9])
INTERVAL = np.array([8.0, 4.0, 8.0])
PAIRS = 40
SKY = galaxies(
    l=np.array([np.sin(np.radians(0.5)), 0.002]),
    m=np.array([np.sin(np.radians(-0.4)), -0.004]),
    flux=np.array([2e-5, 5e-5]),
    alpha=np.array([1.0, 0.7]) * ARCSEC,
    e=np.array([0.3 - 0.2j, -0.1 + 0.3j]),
)


def _antennas():
    rng = np.random.default_rng(2)
    centre = np.array([5109.0e3, 2006.6e3, -3239.0e3])
    return centre + rng.uniform(-8e3, 8e3, (2 * PAIRS, 3))


def _uvw(hours):
    """[m], rows sorted by hour angle."""
    places = antenna_uvw(_antennas(), np.atleast_1d(hours), CENTRE.dec)
    return (places[:, :PAIRS] - places[:, PAIRS:]).reshape(-1, 3)


def _losses(attenuation):
    pairs = np.column_stack([np.arange(PAIRS), np.arange(PAIRS) + PAIRS])
    taken = Integrations(
        np.tile(pairs, (3, 1)), np.repeat(HOURS, PAIRS), np.repeat(INTERVAL, PAIRS)
    )
    return Losses(attenuation, WIDTH, taken)


def _averaged(finer=15):
    """Average over channels and integrations of the visibilities themselves, envelopes and spectra too."""
    x, weight = np.polynomial.legendre.leggauss(finer)
    found = []
    for hour, interval in zip(HOURS, INTERVAL, strict=True):
        total = np.zeros((PAIRS, len(FREQUENCY)), complex)
        for t, of_time in zip(x / 2, weight / 2, strict=True):
            uvw = _uvw(hour + EARTH_ROTATION * interval * t)
            for nu, of_frequency in zip(x / 2, weight / 2, strict=True):
                fine = predict_visibilities(SKY, uvw, FREQUENCY + WIDTH * nu)
                total += of_time * of_frequency * fine
        found.append(total)
    return np.concatenate(found)


def test_a_smeared_galaxy_is_the_average_over_channel_and_integration():
    uvw = _uvw(HOURS)
    both = CombinedAttenuation((BandwidthSmearing(), TimeSmearing(CENTRE.dec)))
    exact = _averaged()
    bare = predict_visibilities(SKY, uvw, FREQUENCY)
    smeared = predict_visibilities(SKY, uvw, FREQUENCY, losses=_losses(both))
    scale = np.abs(bare).max()
    assert np.abs(bare - exact).max() > 0.05 * scale
    # measured 1e-4: the envelope and the baseline change over a sample too
    np.testing.assert_allclose(smeared, exact, atol=3e-4 * scale)


@pytest.mark.parametrize("threads", [1, 2])
def test_each_galaxy_has_its_own_losses(threads):
    uvw = _uvw(HOURS)
    beam = _losses(AiryBeam.from_diameters(np.full(2 * PAIRS, 15.0)))
    together = predict_visibilities(SKY, uvw, FREQUENCY, executor=in_threads(threads), losses=beam)
    parts = []
    for k in range(2):
        source = SKY.select(np.array([k]))
        l, m = float(source.l[0]), float(source.m[0])
        for chan in range(2):
            samples = beam.samples(uvw, FREQUENCY, slice(None), chan)
            factor = beam.attenuation.factor(samples, l, m)
            bare = predict_visibilities(source, uvw, FREQUENCY[chan : chan + 1])[:, 0]
            parts.append(bare * factor)
    np.testing.assert_allclose(together[:, 0], parts[0] + parts[2], rtol=1e-12)
    np.testing.assert_allclose(together[:, 1], parts[1] + parts[3], rtol=1e-12)


def test_losses_need_no_widths_to_be_none_at_the_centre():
    uvw = _uvw(HOURS)
    middle = galaxies(0.0, 0.0, 1e-5, ARCSEC, 0.2j)
    both = CombinedAttenuation((BandwidthSmearing(), TimeSmearing(CENTRE.dec)))
    np.testing.assert_array_equal(
        predict_visibilities(middle, uvw, FREQUENCY, losses=_losses(both)),
        predict_visibilities(middle, uvw, FREQUENCY),
    )
