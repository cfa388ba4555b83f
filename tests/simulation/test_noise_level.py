import math

import numpy as np
import pytest

from uvshear.constants import MICROJANSKY
from uvshear.galaxy import Exponential, Galaxies, SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.spectral_window import Channels
from uvshear.predict import predict_visibilities
from uvshear.simulation.noise_level import GalaxyNoise

CHANNELS = Channels.from_band(0.95e9, 1.19e9, 2)


@pytest.fixture(scope="module")
def coverage():
    track = Track.from_clock(PhaseCentre(0.0, 0.6), ((-3600.0, 3600.0),), 900.0)
    return synthesise(load_layout("vla-b"), track)


def test_the_matched_filter_of_the_median_galaxy_has_the_ratio_asked_for(coverage):
    """Measured over 400 noise draws; a sigma of the complex modulus instead of one part gives 14, not 10."""
    flux = np.array([20 * MICROJANSKY])
    noise = GalaxyNoise(float(flux[0]), 10.0).scaled_to(coverage, CHANNELS, Exponential())
    zero = np.zeros(1)
    size = SizeFluxRelation().median(flux)
    galaxy = Galaxies(zero, zero, flux, size, zero.astype(complex), np.array([-0.7]))
    vis = predict_visibilities(galaxy, coverage.uvw, CHANNELS.frequency)
    rng = np.random.default_rng(4)
    sigma = noise.stokes_i_sigma
    shape = (400, *vis.shape)
    drawn = vis + sigma * (rng.normal(size=shape) + 1j * rng.normal(size=shape))
    fitted = np.sum((drawn * vis.conj()).real, axis=(1, 2)) / np.sum(np.abs(vis) ** 2)
    snr_error = 10 / math.sqrt(2 * len(fitted))
    assert abs(1 / fitted.std() - 10) < 3 * snr_error
    assert snr_error < 0.4
