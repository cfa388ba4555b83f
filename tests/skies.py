"""Small skies and small arrays for tests: what many of them begin with."""

import numpy as np

from uvshear.constants import ARCSEC, SPEED_OF_LIGHT
from uvshear.galaxy import Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import EARTH_ROTATION, Track, synthesise
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.layout import load_layout

L_BAND = np.array([1.4e9])


def galaxies(l=0.0, m=0.0, flux=1.0, alpha=1.5 * ARCSEC, e=0j, beta=-0.7):
    """Galaxies of what is given, broadcast against one another."""
    values = np.broadcast_arrays(*(np.atleast_1d(x) for x in (l, m, flux, alpha, e, beta)))
    real = [np.array(value, float) for value in (*values[:4], values[5])]
    return Galaxies(
        l=real[0],
        m=real[1],
        flux=real[2],
        scale_length=real[3],
        ellipticity=np.array(values[4], complex),
        spectral_index=real[4],
    )


def random_baselines(rows, longest, seed=1, depth=0.5):
    """Baselines [m] within a disc of radius ``longest``, dense at its centre; w up to ``depth`` times that."""
    rng = np.random.default_rng(seed)
    radius = longest * rng.uniform(size=rows)
    angle = rng.uniform(0, 2 * np.pi, rows)
    w = depth * longest * rng.uniform(-1, 1, rows)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), w])


def vla(configuration="b", dec=40.0, samples=8, hours=4.0):
    """Baselines [m] and phase centre of a VLA track about transit: 351 rows a sample."""
    centre = PhaseCentre(1.0, float(np.radians(dec)))
    half = hours * 3600 * EARTH_ROTATION / 2
    track = Track(centre, ((-half, half),), hours * 3600 / samples * (1 - 1e-9))
    return synthesise(load_layout(f"vla-{configuration}"), track).uvw, centre


def wavelengths(uvw, frequency=L_BAND[0]):
    """(u, v) of one frequency [wavelengths]."""
    return uvw[:, :2] * frequency / SPEED_OF_LIGHT


def facet_of_samples(uv, weights, galaxy, profile, rng=None):
    """Facet whose cells are samples, not averages: D = S P V + noise of variance P in each component.

    ``galaxy`` is one of ``galaxies()``; its l, m are offsets from the facet's centre.
    """
    x, y = 2 * np.pi * uv.T
    e, alpha = galaxy.ellipticity[0], galaxy.scale_length[0]
    inverse = np.linalg.inv([[1 - e.real, -e.imag], [-e.imag, 1 + e.real]])
    q = alpha**2 * np.sum((inverse.T @ np.stack([x, y])) ** 2, axis=0)
    model = galaxy.flux[0] * profile.envelope(q) * np.exp(1j * (x * galaxy.l[0] + y * galaxy.m[0]))
    correlation = weights * model
    if rng is not None:
        noise = rng.normal(size=(2, len(uv)))
        correlation = correlation + np.sqrt(weights) * (noise[0] + 1j * noise[1])
    return Facet(uv, correlation, weights)


def flux_of_snr(snr, uv, weights, galaxy, profile):
    """Flux at which S sqrt<m, m> is ``snr``."""
    facet = facet_of_samples(uv, weights, galaxy, profile)
    return snr * galaxy.flux[0] / np.sqrt(np.sum(np.abs(facet.correlation) ** 2 / weights))
