"""Facets drawn directly for the tests of the fit: cells are single samples of a random array."""

from dataclasses import replace

import numpy as np

from tests.skies import facet_of_samples, flux_of_snr, galaxies
from uvshear.constants import ARCSEC
from uvshear.galaxy import Exponential, Gaussian
from uvshear.shapes.prior import ShapePrior

ALPHA = 1.5 * ARCSEC
EXPONENTIAL, GAUSSIAN = Exponential(), Gaussian()
PRIOR = ShapePrior(float(np.log(ALPHA)), 0.3)


def samples(number=600, seed=1, reach=3.0):
    """Half a plane of (u, v) up to 2 pi alpha |k| = ``reach``, and weights about 1e12 Jy^-2."""
    rng = np.random.default_rng(seed)
    radius = reach / (2 * np.pi * ALPHA) * rng.uniform(0.02, 1, number)
    angle = rng.uniform(0, np.pi, number)
    uv = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    return uv, 1e12 * rng.uniform(0.5, 2, number)


def noise_free(e=0j, alpha=ALPHA, l=0.0, m=0.0, snr=1000.0, profile=EXPONENTIAL, **array):
    """Facet of one galaxy without noise, and the galaxy."""
    uv, weights = samples(**array)
    galaxy = galaxies(l, m, 1e-4, alpha, e)
    galaxy = replace(galaxy, flux=np.array([flux_of_snr(snr, uv, weights, galaxy, profile)]))
    return facet_of_samples(uv, weights, galaxy, profile), galaxy


def noisy(rng, e=0j, alpha=ALPHA, l=0.0, m=0.0, snr=30.0, profile=EXPONENTIAL, **array):
    """Facet with noise: in each component of a cell of variance its power, so that <d, m> has variance <m, m>."""
    _, galaxy = noise_free(e, alpha, l, m, snr, profile, **array)
    return facet_of_samples(*samples(**array), galaxy, profile, rng), galaxy
