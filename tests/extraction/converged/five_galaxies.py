"""Five galaxies before and after a change of the first, as tests of the interaction take them."""

from dataclasses import dataclass

import numpy as np

from tests.extraction.converged.major_cycles import GRIDDING, LONGEST, PROFILE, changed
from tests.reference import plane
from tests.skies import L_BAND, galaxies, random_baselines, vla
from uvshear.constants import ARCSEC
from uvshear.extraction.converged.beams import BeamPlan, gather_beams
from uvshear.extraction.converged.change_image import ChangeImage
from uvshear.extraction.converged.interaction import WINDOW, Interaction, PlacedSource
from uvshear.extraction.converged.major_cycle import gather_residuals
from uvshear.extraction.converged.plan import FacetRequests, plan_major_cycle
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict import predict_visibilities
from uvshear.predict.gridded import ModelledSky
from uvshear.predict.response import Response
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template

SKY = galaxies(
    np.array([0, 30, -110, 300, 700.0]) * ARCSEC + 0.003,
    np.array([0, 16, 100, 290, -400.0]) * ARCSEC - 0.001,
    np.array([1.0, 0.6, 0.4, 0.8, 0.5]),
    np.array([4.0, 3.2, 3.6, 4.5, 3.0]) * ARCSEC,
    np.array([0.3 - 0.2j, -0.4j, 0.1 + 0.3j, 0.0, -0.3]),
)
"""The first changes; the others are 34, 149, 417 and 806 arcsec away: the image ends between 280 and 527."""

CHANGES = {
    "flux": changed(SKY, 0, flux=1.3),
    "ellipticity": changed(SKY, 0, ellipticity=0.2 + 0.1j),
    "size": changed(SKY, 0, scale_length=5 * ARCSEC),
    "place": changed(SKY, 0, l=SKY.l[0] + 1.0 * ARCSEC, m=SKY.m[0] - 1.7 * ARCSEC),
}


@dataclass(frozen=True)
class FiveGalaxies:
    """Five galaxies, seen without noise, as they stand at a major cycle."""

    uvw: np.ndarray

    def __post_init__(self):
        rng = np.random.default_rng(3)
        vis = predict_visibilities(SKY, self.uvw, L_BAND, PROFILE)
        seen = Visibilities(self.uvw, L_BAND, vis, rng.uniform(0.5, 2, vis.shape))
        requests = FacetRequests(SKY.l, SKY.m, np.full(5, 150 * ARCSEC), np.full(5, LONGEST))
        values = {"observation": VisibilitySet(vla("b")[1], (seen,))}
        values["plan"] = plan_major_cycle(requests, 0.0, LONGEST)
        for name, value in values.items():
            object.__setattr__(self, name, value)
        beam_plan = BeamPlan.around(SKY, Response.from_sky(SKY), 0.0, LONGEST, self.plan.pixel)
        beams = gather_beams(self.observation, beam_plan, Response.from_sky(SKY), GRIDDING)
        object.__setattr__(self, "beams", beams)
        object.__setattr__(self, "before", self.residuals(SKY))

    def residuals(self, sky):
        model = ModelledSky(sky, np.full(5, 120 * ARCSEC), Response.from_sky(sky), PROFILE)
        return gather_residuals(self.observation, self.plan, model, GRIDDING)

    def interaction(self):
        return Interaction(self.plan, self.beams, PROFILE)

    def after(self, sky):
        """Return the image of the change of the first galaxy."""
        image = ChangeImage(self.interaction())
        _, change = self.rendered(0, SKY, sky)
        image.add(0, change)
        image.set_flux_changes(sky.flux - SKY.flux)
        return image

    def rendered(self, k, before, after):
        """Return the change of a source in units of the noise, and that of the image around it."""
        image = np.empty((WINDOW, WINDOW), np.float32)
        change = self.interaction().render(k, self.source(before, k), self.source(after, k), image)
        return change, image

    def source(self, sky, k):
        offset = np.array([sky.l[k], sky.m[k]]) - self.plan.place[k] * self.plan.pixel
        e, size = complex(sky.ellipticity[k]), float(sky.scale_length[k])
        return PlacedSource(float(sky.flux[k]), tuple(offset), e, size)

    def seen_in(self, image, k):
        """Return what an image of changes takes from a facet, centred on its source."""
        cutout = self.plan.cutouts[k]
        facet = np.zeros(len(cutout.uv), np.complex64)
        image.subtract_from(facet, k)
        cutout.recentre(facet, tuple(self.plan.offset[k]))
        return facet

    def gradient(self, facet, k):
        """Return the gradient of a source's log likelihood by its parameters, each in units of its error."""
        cutout = self.plan.cutouts[k]
        fit = GalaxyFit(
            float(SKY.flux[k]),
            np.zeros(2),
            complex(SKY.ellipticity[k]),
            float(SKY.scale_length[k]),
            1.0,
        )
        responses = Template(cutout.uv, PROFILE).responses(fit)
        norm = np.sum(self.beams.power(k, cutout) * np.abs(responses) ** 2, axis=1)
        return np.sum(np.real(responses * np.conj(facet)), axis=1) / np.sqrt(norm)

    def change_of_first(self, sky):
        """Return the change of the first galaxy's visibilities on the cells of its facet."""
        uv = self.plan.cutouts[0].uv
        offset = sky.l[0] - SKY.l[0], sky.m[0] - SKY.m[0]
        new = plane.galaxy(uv, sky.flux[0], offset, sky.ellipticity[0], sky.scale_length[0])
        old = plane.galaxy(uv, SKY.flux[0], (0, 0), SKY.ellipticity[0], SKY.scale_length[0])
        return new - old

    def significance(self, sky):
        power = self.beams.power(0, self.plan.cutouts[0])
        return float(np.sqrt(np.sum(power * np.abs(self.change_of_first(sky)) ** 2)))


def before_a_vla():
    return FiveGalaxies(vla("b", samples=6)[0])


def before_an_array_with_a_core():
    """Nine baselines in ten are below 20 m: their plateau reaches over the whole field."""
    core = random_baselines(1500, 20.0, seed=5)
    return FiveGalaxies(np.concatenate([core, random_baselines(150, 1e4, seed=6)]))
