"""Small surveys and samples for the tests."""

import numpy as np

from uvshear.constants import MICROJANSKY
from uvshear.galaxy import PowerLawFlux
from uvshear.reproduce.facet_ways import ExactFacetWay, FacetWay
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.shape_sample import FLAGS, ShapeSample
from uvshear.shapes.measurement import FitFlag
from uvshear.simulation.population import Population

POINTING = PaperPointing(integration=7200.0)
"""Four samples of the track: 77 thousand rows."""

BRIGHT = Population(flux=PowerLawFlux(minimum=50 * MICROJANSKY))


def small_survey(way: FacetWay | None = None, **options) -> MockSurvey:
    """Survey of bright galaxies with little noise."""
    settings = {"population": BRIGHT, "flux": 50 * MICROJANSKY, "snr": 100.0, **options}
    return MockSurvey(way or ExactFacetWay(), POINTING, **settings)


def sample_of(measured, true=None, **columns) -> ShapeSample:
    """Sample with an error of 0.1 in each component, and flux 20 uJy."""
    measured = np.asarray(measured, complex)
    n = len(measured)
    defaults = {
        "galaxy": np.arange(n),
        "shear": np.zeros(n, int),
        "realisation": np.zeros(n, int),
        "flux": np.full(n, 20 * MICROJANSKY),
        "true": measured if true is None else np.asarray(true, complex),
        "measured": measured,
        "error": np.full((n, 2), 0.1),
        "e_sigma": np.full(n, 0.1),
        "snr": np.full(n, 20.0),
        "flag": np.full(n, FLAGS.index(FitFlag.OK)),
    }
    return ShapeSample(**(defaults | columns))
