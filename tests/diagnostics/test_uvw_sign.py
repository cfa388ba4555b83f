"""The sign of UVW, judged by the visibilities."""

from dataclasses import replace

import numpy as np
import pytest

from tests.skies import L_BAND, galaxies, vla
from uvshear.constants import ARCMIN
from uvshear.diagnostics.uvw_sign import opposite_sign_significance
from uvshear.galaxy import Exponential
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Visibilities
from uvshear.predict import predict_visibilities
from uvshear.predict.at_samples import predict_at_samples

UVW, _ = vla("b")
NEAR = galaxies(
    np.array([1.0, -3.0]) * ARCMIN, np.array([2.0, 0.5]) * ARCMIN, np.array([1e-3, 2e-3])
)
CENTRAL = galaxies(0.0, 0.0, 5e-3)


def significance(sky, catalogue, *, sign=1, noise=1e-2, conjugates=False, weight=1e4):
    """Read the sky's visibilities with ``sign`` times their UVW, and judge them by a catalogue."""
    rng = np.random.default_rng(1)
    vis = predict_visibilities(sky, UVW, L_BAND)
    vis = vis.conj() if conjugates else vis
    vis = vis + noise * (rng.normal(size=vis.shape) + 1j * rng.normal(size=vis.shape))
    block = Visibilities(sign * UVW, L_BAND, vis, np.full(vis.shape, weight))
    samples = Samples.from_visibilities(block, 0.0, np.inf)
    return opposite_sign_significance(
        samples, predict_at_samples(catalogue, samples, Exponential())
    )


def test_the_right_sign_is_not_remarked_on():
    assert significance(NEAR, NEAR) is None


@pytest.mark.parametrize("turned", [{"sign": -1}, {"conjugates": True}])
def test_a_wrong_sign_is_found(turned):
    imaginary, noise = predict_visibilities(NEAR, UVW, L_BAND).imag, 5e-3
    scatter = np.sqrt(np.sum(imaginary**2 * (noise**2 + imaginary**2)))
    expected = np.sum(imaginary**2) / scatter
    assert expected > 8
    # Its own error is 1.
    assert significance(NEAR, NEAR, noise=noise, **turned) == pytest.approx(expected, abs=3)


def test_baselines_and_phases_that_are_both_opposite_agree():
    """As LOFAR and WSRT store them."""
    assert significance(NEAR, NEAR, sign=-1, conjugates=True, noise=1e-3) is None


def test_wrong_weights_do_not_matter():
    low, high = (significance(NEAR, NEAR, sign=-1, noise=1e-3, weight=w) for w in (1.0, 1e8))
    assert low == pytest.approx(high, rel=1e-3)


def test_a_source_at_the_centre_does_not_tell():
    assert significance(CENTRAL, CENTRAL, sign=-1, noise=1e-4) is None


def test_noise_does_not_tell():
    nobody = replace(NEAR, flux=0 * NEAR.flux)
    assert significance(nobody, NEAR, noise=1e-3) is None


@pytest.mark.parametrize("factor", [-100.0, -0.01])
def test_a_correlation_of_another_strength_is_not_the_sky_of_the_catalogue(factor):
    """As from a sidelobe of the beam: certain, but not of the catalogue's fluxes."""
    vis = factor * predict_visibilities(NEAR, UVW, L_BAND)
    block = Visibilities(UVW, L_BAND, vis, np.ones(vis.shape))
    samples = Samples.from_visibilities(block, 0.0, np.inf)
    model = predict_at_samples(NEAR, samples, Exponential())
    assert opposite_sign_significance(samples, model) is None
    assert opposite_sign_significance(samples, model * -factor) > 20


@pytest.mark.parametrize("sign", [1, -1])
def test_a_bright_source_that_the_catalogue_lacks_does_not_alarm(sign):
    for l, m in ((-1.0, -2.0), (4.0, 1.0), (-1.1, -1.9)):
        other = galaxies(l * ARCMIN * 1.2, m * ARCMIN * 1.2, 1.0)
        assert significance(other, NEAR, noise=1e-3, sign=sign) is None
