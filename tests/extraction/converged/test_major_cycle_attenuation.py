"""Facets of smeared visibilities behind primary beams, against the direct sum."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.major_cycles import GRIDDING, MIXED, PROFILE, nothing, small_field
from tests.skies import vla
from uvshear.extraction.converged.beams import BeamPlan, gather_beams
from uvshear.imaging import tiles
from uvshear.interferometer.attenuation import BandwidthSmearing, CombinedAttenuation, TimeSmearing
from uvshear.interferometer.primary_beam import AiryBeam
from uvshear.interferometer.visibilities import Integrations
from uvshear.predict import predict_visibilities
from uvshear.predict.losses import Losses

CHANNELS, WIDTH = np.array([1.1e9, 1.2e9]), np.array([6e6, 6e6])
ATTENUATION = CombinedAttenuation(
    (
        BandwidthSmearing(),
        TimeSmearing(vla("b")[1].dec),
        AiryBeam.from_diameters(np.array([25.0])),
    )
)


@pytest.fixture(scope="module", autouse=True)
def _small_tiles():
    """Four tiles and more in the finest band, where one would do."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tiles, "CORE", 600)
        yield


@pytest.fixture(scope="module")
def smeared():
    bare = small_field(MIXED, CHANNELS, rows=600)
    count = len(bare.seen)
    taken = Integrations(np.zeros((count, 2), int), np.zeros(count), np.full(count, 60.0))
    losses = Losses(ATTENUATION, WIDTH, taken)
    vis = predict_visibilities(MIXED, bare.seen.uvw, CHANNELS, PROFILE, losses=losses)
    seen = replace(bare.seen, stokes_i=vis, width=WIDTH, integrations=taken)
    return replace(bare, seen=seen, attenuation=ATTENUATION)


def _norms(facets):
    return np.array([np.linalg.norm(facet) for facet in facets])


def test_nothing_is_left_of_a_smeared_sky_whose_losses_are_known(smeared):
    whole = _norms(smeared.residuals(nothing(MIXED)))
    left = _norms(smeared.residuals(MIXED))
    blind = _norms(replace(smeared, attenuation=None).residuals(MIXED))
    # measured 3e-5; without the losses 0.1 to 0.9, but for the one at the centre
    assert np.all(left < 1e-4 * whole)
    assert np.all(blind[1:] > 0.05 * whole[1:])


def test_a_facet_is_its_galaxy_behind_the_beam_that_it_takes(smeared):
    """The filter is that of the tile's centre, the beam that of a node: what is left is an error of the noise."""
    sky = replace(MIXED, flux=MIXED.flux * np.array([0, 1, 0, 0, 0]))
    losses = Losses(ATTENUATION, WIDTH, smeared.seen.integrations)
    vis = predict_visibilities(sky, smeared.seen.uvw, CHANNELS, PROFILE, losses=losses)
    alone = replace(smeared, seen=replace(smeared.seen, stokes_i=vis))
    facet = alone.residuals(nothing(MIXED))[1]
    response = smeared.modelled(MIXED).response
    plan, lm = smeared.plan, np.column_stack([MIXED.l, MIXED.m])
    beam_plan = BeamPlan.around(lm, plan.shortest, plan.longest, plan.pixel)
    beams = gather_beams(smeared.observation, beam_plan, response, GRIDDING)
    cells = plan.cutouts[1]
    model = predict_visibilities(
        replace(sky, l=0 * sky.l, m=0 * sky.m, spectral_index=0 * sky.l),
        np.column_stack([cells.uv, np.zeros(len(cells.uv))]) * 299792458.0,
        np.array([1.0]),
        PROFILE,
    )[:, 0]
    strength = response.strengths(MIXED)[1]
    expected = beams.power(1, cells) * model * strength
    ratio = np.vdot(expected, facet) / np.vdot(expected, expected)
    # a tenth of the flux is lost
    assert strength < 0.95
    assert ratio.real == pytest.approx(1.0, abs=0.02)
