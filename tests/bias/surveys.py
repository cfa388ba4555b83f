"""Short tracks of SKA-Mid, and the shears of the tests."""

import numpy as np

from uvshear.galaxy import Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels

SHEARS = (0.03 * np.exp(0.25j * np.pi), -0.03 * np.exp(0.25j * np.pi))


def plan(declination=-30.0, integration=1800.0):
    centre = PhaseCentre(0.0, np.radians(declination))
    track = Track.from_clock(centre, ((-14400.0, 14400.0),), integration)
    return ObservingPlan(load_layout("ska-mid-aa4"), track, Channels.from_band(0.95e9, 1.19e9, 1))


def one_galaxy(flux, alpha, e, spectral_index=0.0):
    """A galaxy at the phase centre."""
    return Galaxies(
        l=np.zeros(1),
        m=np.zeros(1),
        flux=np.array([flux]),
        scale_length=np.array([alpha]),
        ellipticity=np.array([e]),
        spectral_index=np.array([spectral_index]),
    )
