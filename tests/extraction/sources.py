"""One galaxy before a VLA, as the tests of facets take it."""

from dataclasses import dataclass, replace

import numpy as np

from tests.skies import L_BAND, galaxies, vla
from uvshear.constants import ARCSEC
from uvshear.extraction.paper.facets import Target
from uvshear.galaxy import Exponential, Galaxies
from uvshear.interferometer.summary import summarise
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict import predict_visibilities

PROFILE = Exponential()
ALPHA = 2 * ARCSEC


@dataclass(frozen=True)
class Scene:
    """A noise-free galaxy, what is seen of it, and the target to be cut out."""

    galaxy: Galaxies
    seen: Visibilities
    target: Target

    @property
    def nothing(self) -> Galaxies:
        """The galaxy without flux: a sky in which nothing is known yet."""
        return replace(self.galaxy, flux=np.zeros(1))

    def residual(self, model: Galaxies) -> Visibilities:
        """What is left when a model is subtracted."""
        known = predict_visibilities(model, self.seen.uvw, self.seen.frequency, PROFILE)
        return self.seen.with_stokes_i(self.seen.stokes_i - known)

    def facet(self, method, model: Galaxies | None = None, pieces: int = 1):
        """Facet of the source after one pass with ``model``, in as many chunks as wanted."""
        model = self.nothing if model is None else model
        builder = method.open(self.target, PROFILE)
        residual = self.residual(model)
        for rows in np.array_split(np.arange(len(residual)), pieces):
            builder.add(part(residual, rows), model)
        return builder.facet(model)


def part(chunk: Visibilities, rows: np.ndarray) -> Visibilities:
    return replace(
        chunk, uvw=chunk.uvw[rows], stokes_i=chunk.stokes_i[rows], weights=chunk.weights[rows]
    )


def scene(e=0.3 - 0.2j, l=0.008, m=-0.005, flux=1e-4, uv_min=0.0, frequency=L_BAND) -> Scene:
    uvw, centre = vla("b", samples=6)
    galaxy = galaxies(l, m, flux, ALPHA, e)
    vis = predict_visibilities(galaxy, uvw, frequency, PROFILE)
    weights = np.random.default_rng(3).uniform(0.5, 2.0, vis.shape) * 1e12
    weights[::50] = 0
    seen = Visibilities(uvw, frequency, vis, weights)
    longest = summarise(VisibilitySet(centre, (seen,))).longest
    target = Target(replace(galaxy, flux=np.ones(1)), ALPHA, UvRange(uv_min, longest * 1.01), 1.4e9)
    return Scene(galaxy, seen, target)


def model_on(facet, galaxy, l=0.0, m=0.0):
    """Real envelope of unit flux on a facet's cells, and its phase at (l, m) from the facet's centre."""
    x, y = 2 * np.pi * facet.uv.T
    e = galaxy.ellipticity[0]
    inverse = np.linalg.inv([[1 - e.real, -e.imag], [-e.imag, 1 + e.real]])
    q = galaxy.scale_length[0] ** 2 * np.sum((inverse.T @ np.stack([x, y])) ** 2, axis=0)
    return PROFILE.envelope(q), np.exp(1j * (x * l + y * m))
