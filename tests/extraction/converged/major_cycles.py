"""Small fields before a VLA, as the tests of major cycles take them: half a degree wide, two bands."""

from dataclasses import dataclass, replace

import numpy as np

from tests.skies import L_BAND, galaxies, vla
from uvshear.constants import ARCSEC
from uvshear.extraction.converged.major_cycle import gather_residuals
from uvshear.extraction.converged.plan import (
    FacetRequests,
    MajorCyclePlan,
    plan_major_cycle,
)
from uvshear.galaxy import Exponential, Galaxies
from uvshear.imaging.tiles import Tiling
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.summary import summarise
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict import predict_visibilities
from uvshear.predict.gridded import Gridding, ModelledSky
from uvshear.predict.response import Response

PROFILE = Exponential()
GRIDDING = Gridding(epsilon=1e-5)
LONGEST = 5.4e4
WIDTH = 90 * ARCSEC
HALF_WIDTH = 80 * ARCSEC

SKY = galaxies(
    np.array([0.0001, 0.0062, 0.00635, -0.0021, 0.0047]),
    np.array([0.0002, 0.0055, 0.00557, 0.0044, -0.0012]),
    np.array([1.0, 0.6, 0.4, 0.8, 0.5]),
    np.array([2.0, 1.5, 1.7, 2.5, 1.2]) * ARCSEC,
    np.array([0.3 - 0.2j, -0.4j, 0.1 + 0.3j, 0.0, -0.3]),
)
"""The second and the third are 34 arcsec from one another."""

MIXED = replace(SKY, spectral_index=np.array([-0.7, 0.2, -1.2, -0.7, 0.6]))


@dataclass(frozen=True)
class SmallField:
    """Visibilities of a sky, and the plan of a major cycle."""

    seen: Visibilities
    plan: MajorCyclePlan
    attenuation: Attenuation | None = None

    @property
    def observation(self) -> VisibilitySet:
        return VisibilitySet(vla("b")[1], (self.seen,))

    def in_pieces(self, pieces: int) -> VisibilitySet:
        """The same rows in as many chunks."""
        parts = tuple(
            replace(
                self.seen,
                uvw=self.seen.uvw[rows],
                stokes_i=self.seen.stokes_i[rows],
                weights=self.seen.weights[rows],
            )
            for rows in np.array_split(np.arange(len(self.seen)), pieces)
        )
        return VisibilitySet(vla("b")[1], parts)

    def residuals(self, model: Galaxies, gridding: Gridding = GRIDDING):
        return gather_residuals(self.observation, self.plan, self.modelled(model), gridding)

    def modelled(self, model: Galaxies) -> ModelledSky:
        response = Response.from_sky(model, summarise(self.observation).probes, self.attenuation)
        return ModelledSky(model, np.full(len(model), HALF_WIDTH), response, PROFILE)


def small_field(
    truth: Galaxies = SKY,
    frequency=L_BAND,
    shortest=0.0,
    rows=1500,
    centred: Galaxies | None = None,
    width=600,
) -> SmallField:
    """Observe ``truth`` without noise on some rows of a VLA; facets are centred on ``centred``, truth unless given.

    With tiles of 600 pixels there are four and more in the finest band.
    """
    uvw, _ = vla("b", samples=6)
    uvw = uvw[np.random.default_rng(4).permutation(len(uvw))[:rows]]
    vis = predict_visibilities(truth, uvw, frequency, PROFILE)
    weights = np.random.default_rng(3).uniform(0.5, 2.0, vis.shape)
    weights[::40] = 0
    centred = truth if centred is None else centred
    count = len(centred)
    requests = FacetRequests(centred.l, centred.m, np.full(count, WIDTH), np.full(count, LONGEST))
    plan = plan_major_cycle(requests, shortest, LONGEST, tiling=Tiling(width))
    return SmallField(Visibilities(uvw, frequency, vis, weights), plan)


def nothing(sky: Galaxies = SKY) -> Galaxies:
    """The same galaxies without flux."""
    return replace(sky, flux=np.zeros(len(sky)))


def changed(sky: Galaxies, source: int, **parameters) -> Galaxies:
    """A sky with other parameters of one galaxy."""
    columns = {name: getattr(sky, name).copy() for name in parameters}
    for name, value in parameters.items():
        columns[name][source] = value
    return replace(sky, **columns)
