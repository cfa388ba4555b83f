"""Facets of smeared visibilities behind primary beams, against the direct sum."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.major_cycles import (
    GRIDDING,
    LONGEST,
    MIXED,
    PROFILE,
    nothing,
    small_field,
)
from tests.reference import plane
from tests.reference import visit as reference
from tests.skies import vla
from uvshear.extraction.converged.beams import BeamPlan, gather_beams
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


def test_a_facet_is_its_galaxy_behind_its_own_beam(smeared):
    """Filter and beam are the source's own."""
    sky = replace(MIXED, flux=MIXED.flux * np.array([0, 1, 0, 0, 0]))
    losses = Losses(ATTENUATION, WIDTH, smeared.seen.integrations)
    vis = predict_visibilities(sky, smeared.seen.uvw, CHANNELS, PROFILE, losses=losses)
    alone = replace(smeared, seen=replace(smeared.seen, stokes_i=vis))
    facet = alone.residuals(nothing(MIXED))[1]
    response = smeared.modelled(MIXED).response
    plan = smeared.plan
    beam_plan = BeamPlan.around(MIXED, response, plan.shortest, plan.longest, plan.pixel)
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
    assert ratio.real == pytest.approx(1.0, abs=1e-3)


def _own_factor(seen, source):
    """Spectrum and losses of a source in every row and channel."""
    losses = Losses(ATTENUATION, WIDTH, seen.integrations)
    place = float(MIXED.l[source]), float(MIXED.m[source])
    every = slice(None)
    columns = [
        ATTENUATION.factor(losses.samples(seen.uvw, CHANNELS, every, chan), *place)
        for chan in range(len(CHANNELS))
    ]
    return np.stack(columns, axis=1) * (CHANNELS / 1.4e9) ** MIXED.spectral_index[source]


def _error(got, expected):
    return float(np.linalg.norm(got - expected) / np.linalg.norm(expected))


@pytest.mark.parametrize("source", range(len(MIXED)))
def test_facet_and_beam_have_the_filter_of_their_source(smeared, source):
    """Direct sums with the source's own factor."""
    response, plan, seen = smeared.modelled(MIXED).response, smeared.plan, smeared.seen
    beam_plan = BeamPlan.around(MIXED, response, plan.shortest, plan.longest, plan.pixel)
    beams = gather_beams(smeared.observation, beam_plan, response, GRIDDING)
    factor = _own_factor(seen, source) / response.strengths(MIXED)[source]
    cells = plan.cutouts[source]
    place, uv_range = plan.place[source] * plan.pixel, (0.0, LONGEST)
    expected = reference.residual_facet(
        seen, seen.stokes_i, factor, cells, place, plan.offset[source], uv_range
    )
    facet = smeared.residuals(nothing(MIXED))[source]
    assert (
        _error(facet, expected) < 1e-4
    )  # measured 4e-5; the filter of the centre of the tile: 0.02
    centre = MIXED.l[source], MIXED.m[source]
    square = reference.beam_square(seen, factor, cells.size, cells.pixel, centre, uv_range)
    expected = plane.facet(square, cells.pixel, cells.uv, cells.multiplicity).real
    # measured 1.5e-3, most of it for the distance of the node
    assert _error(beams.power(source, cells), expected) < 4e-3
