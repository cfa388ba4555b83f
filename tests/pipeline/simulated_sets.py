"""Small simulated sets of several arrays, in memory, with their true skies and with weights that may be wrong."""

from dataclasses import replace

import numpy as np

from tests.skies import galaxies
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.galaxy import Exponential
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.simulation.observation import SimulatedObservation

SIGMA = 1e-3
"""Noise of a visibility [Jy]."""

DECLINATIONS = {"ska-mid-aa4": -30.0, "meerkat": -30.0, "vla-a": 40.0, "vla-b": 40.0}
ANTENNAS = 16


def sky_of(brightest):
    """Three discs near the centre, and a point further out that is twice as bright."""
    flux = brightest * SIGMA * np.array([1.0, 0.6, 0.4, 2.0])
    l = np.array([0.7, -1.5, 0.3, 4.0]) * ARCMIN
    m = np.array([0.5, 1.0, -2.0, -3.0]) * ARCMIN
    alpha = np.array([1.5, 1.0, 2.0, 0.0]) * ARCSEC
    return galaxies(l, m, flux, alpha, np.array([0.3, -0.2j, 0.1 + 0.2j, 0.0]))


def simulated_set(array="vla-a", integration=300.0, sky=None, seed=1):
    """Observe a sky, for 8 hours or for 30 integrations."""
    layout = load_layout(array)
    chosen = np.sort(np.random.default_rng(3).permutation(len(layout))[:ANTENNAS])
    layout = replace(
        layout,
        antenna_names=tuple(layout.antenna_names[k] for k in chosen),
        positions=layout.positions[chosen],
        diameters=layout.diameters[chosen],
    )
    half = min(4 * 3600.0, 15 * integration)
    centre = PhaseCentre(0.3, float(np.radians(DECLINATIONS[array])))
    observation = SimulatedObservation(
        coverage=synthesise(layout, Track.from_clock(centre, ((-half, half),), integration)),
        channels=Channels.from_band(1.30e9, 1.34e9, 4),
        galaxies=sky_of(20.0) if sky is None else sky,
        profile=Exponential(),
        noise=ScaledNoise(SIGMA),
        seed=seed,
    )
    return VisibilitySet(centre, tuple(observation.chunks()))


def changed(observation, *, ratio=1.0, has_hands=False, sign=1.0, conjugates=False):
    """Change the weights such that the noise is ``ratio`` times what they claim, or UVW, or the phase of the data."""
    blocks = []
    for block in observation.blocks:
        data = block.stokes_i.conj() if conjugates else block.stokes_i
        powers = block.hand_powers * ratio**2 if has_hands else None
        weights = (block.weights * ratio**2).astype(np.float32)
        blocks.append(
            replace(block, stokes_i=data, uvw=sign * block.uvw, weights=weights, hand_powers=powers)
        )
    return VisibilitySet(observation.phase_centre, tuple(blocks))
