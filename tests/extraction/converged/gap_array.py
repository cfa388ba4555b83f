"""An array with a gap: pairs of stations, far from one another."""

import numpy as np

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import ArrayLayout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels

CENTRE = PhaseCentre(1.0, 0.9)
WAVELENGTH = 2.0
"""[m]"""


def gap_layout(pairs=4, sites=10, apart=350.0, shortest=6e3, longest=8e4):
    """Sites on a spiral, of which some have a second station ``apart`` metres away."""
    rng = np.random.default_rng(2)
    radius = np.geomspace(shortest, longest / 2, sites)
    angle = 2.4 * np.arange(sites)
    east, north = radius * np.cos(angle), radius * np.sin(angle)
    turn = rng.uniform(0, 2 * np.pi, pairs)
    east = np.append(east, east[:pairs] + apart * np.cos(turn))
    north = np.append(north, north[:pairs] + apart * np.sin(turn))
    latitude = CENTRE.dec
    sine, cosine = np.sin(latitude), np.cos(latitude)
    positions = np.column_stack(
        [6.37e6 * cosine - sine * north, east, 6.37e6 * sine + cosine * north]
    )
    count = sites + pairs
    return ArrayLayout(
        "gap", tuple(f"S{k}" for k in range(count)), positions, np.full(count, 30.0), ""
    )


def gap_plan(hours=6.0, integration=300.0, **changes):
    """A track about transit at 150 MHz."""
    half = hours * 1800
    track = Track.from_clock(CENTRE, ((-half, half),), integration)
    frequency = 299792458.0 / WAVELENGTH
    channels = Channels(np.array([frequency]), np.array([1e5]))
    return ObservingPlan(gap_layout(**changes), track, channels)
