"""Shapes of galaxies far off the centre, averaged over channels and integrations, behind the beams of dishes."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.fields import extract
from tests.skies import galaxies
from uvshear.constants import ARCSEC
from uvshear.execution import Resources, in_threads
from uvshear.extraction import MeasurementOptions, Model
from uvshear.galaxy import CatalogueSize
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import EARTH_ROTATION, antenna_uvw
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.primary_beam import AiryBeam
from uvshear.interferometer.visibilities import Integrations, Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.predict import predict_visibilities
from uvshear.predict.losses import Losses

CENTRE = PhaseCentre(0.0, np.radians(-30.0))
FREQUENCY = np.array([1.0e9, 1.15e9])
LAYOUT = load_layout("ska-mid-aa2")
HOURS = np.linspace(-1.0, 1.0, 8)
FIRST, SECOND = np.triu_indices(len(LAYOUT), 1)
NEAR, FAR = (0.5, 1e6, 8.0, 1e7), (1.0, 0.5e6, 4.0, 1e8)
"""Distance from the centre [deg], width of the channels [Hz], length of the integrations [s], weights [Jy^-2]: an SNR
of some hundreds, below which priors have a say."""


def _sky(degrees):
    far = np.sin(np.radians(degrees))
    return replace(
        galaxies(
            l=np.array([far, -0.7 * far, 0.0]),
            m=np.array([0.0, 0.7 * far, -far]),
            flux=np.array([5e-3, 5e-3, 5e-3]),
            alpha=np.array([1.0, 0.8, 1.2]) * ARCSEC,
            e=np.array([0.3 - 0.1j, -0.2 + 0.3j, 0.1 + 0.1j]),
        ),
        spectral_index=np.array([-0.7, -1.2, 0.1]),
    )


SKY = _sky(0.5)
DISHES = AiryBeam.from_diameters(LAYOUT.diameters)


def _uvw(hours):
    places = antenna_uvw(LAYOUT.positions, np.atleast_1d(hours), CENTRE.dec)
    return (places[:, FIRST] - places[:, SECOND]).reshape(-1, 3)


def _observed(degrees, width, interval, weight):
    """Averages over 5 x 5 nodes of each channel and integration, behind dishes of the layout's two sizes."""
    x, share = np.polynomial.legendre.leggauss(5)
    pairs = np.tile(np.column_stack([FIRST, SECOND]), (len(HOURS), 1))
    count = len(pairs)
    taken = Integrations(pairs, np.zeros(count), np.full(count, interval))
    widths = np.full(len(FREQUENCY), width)
    dishes = Losses(DISHES, widths, taken)
    vis = np.zeros((count, len(FREQUENCY)), complex)
    for t, of_time in zip(x / 2, share / 2, strict=True):
        uvw = _uvw(HOURS + EARTH_ROTATION * interval * t)
        for nu, of_channel in zip(x / 2, share / 2, strict=True):
            moved = FREQUENCY + width * nu
            fine = predict_visibilities(
                _sky(degrees), uvw, moved, executor=in_threads(2), losses=dishes
            )
            vis += of_time * of_channel * fine
    weights = np.full(vis.shape, weight)
    block = Visibilities(_uvw(HOURS), FREQUENCY, vis, weights, width=widths, integrations=taken)
    return VisibilitySet(CENTRE, (block,))


@pytest.fixture(scope="module")
def observation():
    return _observed(*NEAR)


def _worst(observation, sky=SKY, **losses):
    """Largest error of e, and of the flux over itself."""
    model = Model(size=CatalogueSize(), **losses)
    options = MeasurementOptions(model, resources=Resources(in_threads(2)))
    catalogue = catalogue_from_galaxies(sky, CENTRE)
    found = extract(observation, catalogue, options).measurements
    e = np.array([complex(*found[k].ellipticity) for k in range(len(sky))])
    flux = np.array([found[k].flux for k in range(len(sky))])
    return np.abs(e - SKY.ellipticity).max(), np.abs(flux / SKY.flux - 1).max()


def test_shapes_half_a_degree_off_are_right(observation):
    error, flux = _worst(observation, primary_beam=DISHES)
    # measured 3e-4 and 3e-5
    assert error < 1e-3
    assert flux < 1e-3


def test_shapes_a_degree_off_are_right():
    error, flux = _worst(_observed(*FAR), _sky(1.0), primary_beam=DISHES)
    # measured 7e-4 and 2e-4, next to the first null of the dishes' beam
    assert error < 2e-3
    assert flux < 1e-3


def test_without_the_losses_they_are_wrong(observation):
    error, flux = _worst(observation, smears=False)
    # measured 0.076: 0.080 for want of the channels, 0.013 of the integrations, 0.004 of the unlike dishes
    assert error > 0.05
    assert flux > 0.3


def test_spectra_of_their_own_matter(observation):
    flat = replace(SKY, spectral_index=np.full(3, -0.7))
    error, flux = _worst(observation, flat, primary_beam=DISHES)
    assert error < 5e-3
    assert flux > 0.05
