"""Two galaxies that touch, without noise: what one is taken for shows in the shape of the other."""

from dataclasses import replace

import numpy as np

from tests.skies import galaxies, vla
from uvshear.constants import ARCSEC
from uvshear.extraction import MeasurementOptions
from uvshear.galaxy import CatalogueSize
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.predict import predict_visibilities

FREQUENCY = np.array([1.4e9])
SIZES = np.array([2.2, 2.0]) * ARCSEC
OPTIONS = MeasurementOptions(size=CatalogueSize())
BRIGHT, FAINT = 0, 1


def pair():
    """Observation, catalogue and truth; weights are those of an SNR of some hundreds."""
    uvw, centre = vla("b", samples=4)
    truth = galaxies(
        np.array([0.0, 12.0]) * ARCSEC,
        np.array([0.0, 5.0]) * ARCSEC,
        np.array([2e-3, 1.5e-3]),
        SIZES,
        np.array([0.4 + 0.2j, -0.3 + 0.3j]),
    )
    vis = predict_visibilities(truth, uvw, FREQUENCY)
    block = Visibilities(uvw, FREQUENCY, vis, np.full(vis.shape, 1e8))
    return VisibilitySet(centre, (block,)), catalogue_from_galaxies(truth, centre), truth


def with_extraction(extraction):
    """Return the options of these tests with another way of telling sources apart."""
    return replace(OPTIONS, extraction=extraction)
