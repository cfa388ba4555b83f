"""Samples of a few dozen baselines near SKA-Mid's place on the Earth."""

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.interferometer.coverage import antenna_uvw
from uvshear.interferometer.samples import Samples

DECLINATION = np.radians(-30.0)
FREQUENCY, WIDTH, INTERVAL = 1.07e9, 1e6, 8.0
L, M = np.sin(np.radians(0.4)), np.sin(np.radians(-0.3))
PAIRS = 60


def _antennas():
    """Positions of antennas up to 20 km from each other."""
    rng = np.random.default_rng(1)
    centre = np.array([5109.0e3, 2006.6e3, -3239.0e3])
    return centre + rng.uniform(-10e3, 10e3, (2 * PAIRS, 3))


def baselines(hour_angle):
    """Baselines [m], of shape (pair, hour angle, 3)."""
    places = antenna_uvw(_antennas(), hour_angle, DECLINATION)
    return np.swapaxes(places[:, :PAIRS] - places[:, PAIRS:], 0, 1)


def samples(**changed):
    uvw = baselines(np.array([0.4]))[:, 0] * (FREQUENCY / SPEED_OF_LIGHT)
    columns = {
        "uvw": uvw,
        "stokes_i": np.zeros(PAIRS, np.complex64),
        "weights": np.ones(PAIRS, np.float32),
        "frequency": np.full(PAIRS, FREQUENCY),
        "bandwidth": np.full(PAIRS, WIDTH, np.float32),
        "interval": np.full(PAIRS, INTERVAL, np.float32),
        "antennas": np.column_stack([np.arange(PAIRS), np.arange(PAIRS) + PAIRS]).astype(np.int16),
    }
    return Samples(**columns | changed)
