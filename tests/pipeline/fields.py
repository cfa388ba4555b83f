"""A VLA field of a few sources, in memory."""

from dataclasses import dataclass

import numpy as np

from tests.skies import galaxies, vla
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.extraction import Method, Model
from uvshear.galaxy import CatalogueSize, Galaxies
from uvshear.geometry.directions import equatorial
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.catalogue import Catalogue
from uvshear.predict import predict_visibilities

FREQUENCY = np.array([1.35e9, 1.45e9])
SIGMA = 1e-4
MODEL = Model(size=CatalogueSize())
METHOD = Method(field_radius=np.radians(0.5))
GOOD = [0, 2, 3, 5]
"""Rows of the catalogue that are galaxies within the field."""


@dataclass(frozen=True)
class Field:
    """The true sky, what was observed of it, and the catalogue."""

    truth: Galaxies
    observation: VisibilitySet
    catalogue: Catalogue


def observe(sky, uvw, centre, seed=None, pieces=2):
    vis = predict_visibilities(sky, uvw, FREQUENCY)
    if seed is not None:
        noise = np.random.default_rng(seed).normal(size=(2, *vis.shape))
        vis += SIGMA * (noise[0] + 1j * noise[1])
    weights = np.full(vis.shape, SIGMA**-2)
    weights[::97] = 0
    rows = np.array_split(np.arange(len(uvw)), pieces)
    return VisibilitySet(
        centre, tuple(Visibilities(uvw[r], FREQUENCY, vis[r], weights[r]) for r in rows)
    )


def catalogue_of_sky(sky, centre, ra=None, dec=None):
    if ra is None:
        ra, dec = equatorial(centre, sky.l, sky.m)
    return Catalogue(
        identifier=np.array([f"s{k}" for k in range(len(sky))]),
        flux=sky.flux,
        spectral_index=sky.spectral_index,
        ra=ra,
        dec=dec,
        scale_length=sky.scale_length,
    )


def vla_field(pieces=2, seed=1):
    uvw, centre = vla("b", samples=6)
    l = np.array([0.0, 1.5, -1.5, -1.0, 60.0, 2.5, 0.0]) * ARCMIN
    m = np.array([0.0, 2.0, 1.0, 1.2, 0.0, -2.0, 0.0]) * ARCMIN
    flux = np.array([1.0, 2.0, 2.0, 0.7, 1.0, 0.5, 9.0]) * 1e-3
    alpha = np.array([2.0, 0.0, 2.5, 1.8, 2.0, 1.6, 2.0]) * ARCSEC
    e = np.array([0.3, 0.0, -0.2 + 0.4j, -0.3j, 0.0, 0.1 + 0.2j, 0.0])
    sky = galaxies(l, m, flux, alpha, e)
    ra, dec = equatorial(centre, l, m)
    ra[6], dec[6] = ra[0] + np.pi, -dec[0]  # behind the Earth
    seen = sky.select(np.array([0, 1, 2, 3, 5]))
    return Field(
        sky, observe(seen, uvw, centre, seed, pieces), catalogue_of_sky(sky, centre, ra, dec)
    )
