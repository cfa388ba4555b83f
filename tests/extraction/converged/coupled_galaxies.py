"""Ten galaxies before a VLA and their couplings, as tests of the Fisher matrix take them."""

from dataclasses import dataclass

import numpy as np

from tests.extraction.converged.major_cycles import GRIDDING, LONGEST, PROFILE
from tests.skies import L_BAND, galaxies, vla
from uvshear.constants import ARCSEC
from uvshear.execution import SERIAL
from uvshear.extraction.converged.beams import BeamPlan, gather_beams
from uvshear.extraction.converged.couplings import Couplings, couple
from uvshear.extraction.converged.interaction import Interaction
from uvshear.extraction.converged.plan import FacetRequests, plan_major_cycle
from uvshear.galaxy import Profile
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict.response import Response
from uvshear.shapes.measurement import GalaxyFit


@dataclass(frozen=True)
class Coupled:
    """Ten galaxies over 17 arcmin before a VLA, and their couplings."""

    place: np.ndarray
    fits: list[GalaxyFit]
    interaction: Interaction
    couplings: Couplings


def coupled_galaxies():
    rng = np.random.default_rng(7)
    lm = rng.uniform(-500, 500, (10, 2)) * ARCSEC
    lm[1] = lm[0] + np.array([8, -5]) * ARCSEC
    lm[2] = lm[0] + np.array([-30, 50]) * ARCSEC
    lm[3:5] = np.array([[-10, 20], [30, -25]]) * ARCSEC  # in squares that touch at a corner
    sky = galaxies(*lm.T, rng.uniform(0.3, 2, 10), 4 * ARCSEC, 0.2 - 0.1j)
    uvw, centre = vla("b", samples=4)
    vis = np.zeros((len(uvw), 1), complex)
    observation = VisibilitySet(centre, (Visibilities(uvw, L_BAND, vis, np.ones(vis.shape)),))
    requests = FacetRequests(*lm.T, np.full(10, 120 * ARCSEC), np.full(10, LONGEST))
    plan = plan_major_cycle(requests, 0.0, LONGEST)
    beam_plan = BeamPlan.around(sky, Response.from_sky(sky), 0.0, LONGEST, plan.pixel)
    beams = gather_beams(observation, beam_plan, Response.from_sky(sky), GRIDDING)
    interaction = Interaction(plan, beams, PROFILE)
    fits = [GalaxyFit(float(flux), np.zeros(2), 0.2 - 0.1j, 4 * ARCSEC, 10.0) for flux in sky.flux]
    return Coupled(lm, fits, interaction, couplings_of(fits, interaction, SERIAL))


@dataclass(frozen=True)
class Now:
    """As much of the state of a sky as couplings take."""

    fits: tuple[GalaxyFit, ...]
    interaction: Interaction
    profile: Profile


@dataclass(frozen=True)
class Sky:
    """A sky that stays as it is."""

    now: Now


def couplings_of(fits, interaction, executor):
    now = Now(tuple(fits), interaction, PROFILE)
    with executor.crew(Sky(now)) as crew:
        return couple(now, crew)
