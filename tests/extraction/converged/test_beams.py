"""Beams against direct sums over visibilities."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.extraction.converged.major_cycles import GRIDDING, LONGEST, MIXED, SKY, small_field
from tests.extraction.sources import PROFILE, scene
from tests.reference import dirty, plane
from tests.reference import visit as reference
from tests.skies import vla
from uvshear.execution import in_threads
from uvshear.extraction.converged.beams import (
    SIZE,
    SPACING,
    WIDE_BAND,
    WIDE_SIZE,
    BeamAccumulator,
    BeamPlan,
    Mixture,
    coarse_spectrum,
    directions,
    gather_beams,
)
from uvshear.extraction.converged.plan import FacetRequests, plan_major_cycle
from uvshear.extraction.paper.exact import ExactFacets
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.predict.response import Response

LM = np.column_stack([SKY.l, SKY.m])


def _gather(field, sky=SKY, **gridding):
    response = field.modelled(sky).response
    plan = BeamPlan.around(sky, response, 0.0, LONGEST, field.plan.pixel)
    return gather_beams(field.observation, plan, response, replace(GRIDDING, **gridding))


@pytest.fixture(scope="module")
def one_channel():
    return small_field()


@pytest.fixture(scope="module")
def beams(one_channel):
    return _gather(one_channel)


def _direct_power(field, gain, direction):
    cutout = field.plan.cutouts[0]
    square = reference.beam_square(
        field.seen, gain, cutout.size, cutout.pixel, direction, (0.0, LONGEST)
    )
    return plane.facet(square, cutout.pixel, cutout.uv, cutout.multiplicity).real


def _error(got, expected):
    return float(np.linalg.norm(got - expected) / np.linalg.norm(expected))


def test_power_at_a_direction_is_the_fourier_sum_of_the_direct_beam(one_channel, beams):
    nodes, nearest = directions(LM)
    node = nodes[nearest[1]]
    expected = _direct_power(one_channel, 1.0, node)
    # measured 1e-7; baselines as from the phase centre: 1e-2
    assert _error(beams.power(1, one_channel.plan.cutouts[0]), expected) < 1e-6


@pytest.mark.parametrize("source", [0, 2])
def test_power_at_a_source_is_nearly_that_of_the_nearest_direction(one_channel, beams, source):
    expected = _direct_power(one_channel, 1.0, LM[source])
    # measured 4e-4 and 4e-3, 60 and 560 arcsec from it; that of the direction farthest away: 1e-2
    assert _error(beams.power(source, one_channel.plan.cutouts[source]), expected) < 8e-3


def test_power_of_several_channels_has_the_common_spectrum_squared():
    field = small_field(MIXED, np.array([1.05e9, 1.4e9]), rows=500)
    nodes, nearest = directions(LM)
    expected = _direct_power(field, (field.seen.frequency / 1.4e9) ** -0.7, nodes[nearest[0]])
    got = _gather(field, MIXED).power(0, field.plan.cutouts[0])
    assert _error(got, expected) < 1e-6  # measured 2e-7; the spectrum once, not squared: 0.1


def test_norms_are_those_of_exact_facets():
    """<m, m> of a galaxy, by cells of another size and pixel."""
    seen = scene()
    exact = seen.facet(ExactFacets())
    galaxy = seen.galaxy
    longest = seen.target.informative_uv_max
    requests = FacetRequests(galaxy.l, galaxy.m, np.full(1, 4e-4), np.full(1, longest))
    plan = plan_major_cycle(requests, 0.0, longest)
    response = Response.from_sky(galaxy)
    observation = VisibilitySet(vla("b")[1], (seen.seen,))
    beam_plan = BeamPlan.around(galaxy, response, 0.0, longest, plan.pixel)
    beams = gather_beams(observation, beam_plan, response, GRIDDING)
    norms = []
    for uv, power in (
        (exact.uv, exact.power),
        (plan.cutouts[0].uv, beams.power(0, plan.cutouts[0])),
    ):
        model = plane.galaxy(uv, 1.0, (0.0, 0.0), galaxy.ellipticity[0], galaxy.scale_length[0])
        norms.append(float(np.sum(power * np.abs(model) ** 2)))
    assert PROFILE.envelope(np.zeros(1)) == 1
    assert norms[1] == pytest.approx(norms[0], rel=1e-3)  # measured 1e-4


def test_the_beam_of_the_short_baselines_is_their_direct_sum(one_channel, beams):
    seen = one_channel.seen
    (l, m), *_ = directions(LM)[0]
    short = seen.uv_distance < WIDE_BAND * LONGEST
    assert 20 < np.count_nonzero(short) < 500
    n = np.sqrt(1 - l**2 - m**2)
    u, v, w = seen.uvw.T
    flat = np.column_stack([u - w * l / n, v - w * m / n, np.zeros(len(w))])
    i, j = np.random.default_rng(2).integers(40, WIDE_SIZE - 40, (2, 60))
    apart = (np.column_stack([i, j]) - WIDE_SIZE // 2) * beams.wide_pixel
    expected = dirty.beam(flat, seen.frequency, seen.weights * short, *apart.T)
    total = float(seen.weights[short].sum())
    # at the pixels themselves; measured 1e-6
    np.testing.assert_allclose(beams.plateau(apart), expected, rtol=0, atol=1e-5 * total)


def test_the_plateau_is_zero_beyond_its_image(beams):
    beyond = WIDE_SIZE * beams.wide_pixel
    assert np.all(beams.plateau(np.array([[beyond, 0.0], [0.0, -beyond]])) == 0)


def test_an_ending_beam_is_the_beam_up_to_its_end_and_nothing_beyond(beams):
    end = beams.ending(0, 100.0, 200.0)
    x = np.arange(SIZE) - SIZE // 2
    distance = np.hypot(x[:, None], x[None, :])
    np.testing.assert_allclose(end[distance < 99], beams.images[0][distance < 99], rtol=1e-5)
    assert np.all(end[distance >= 200] == 0)


def test_a_coarse_spectrum_is_the_fourier_sum_of_the_fine_beam_on_the_cells_that_it_has(beams):
    beam = beams.ending(0, 100.0, 200.0)
    spectrum = coarse_spectrum(beam)
    half = SIZE // 2
    assert spectrum.shape == (half, half // 2 + 1)
    x = np.arange(SIZE) - SIZE // 2
    for i, j in ((0, 0), (3, 7), (-5, 11), (-100, 60), (120, 3)):
        phase = np.exp(-2j * np.pi * (i * x[:, None] + j * x[None, :]) / SIZE)
        expected = np.sum(beam.astype(float) * phase) / 4
        assert spectrum[i, j] == pytest.approx(expected.real, abs=1e-6 * float(spectrum.max()))


def test_threads_do_not_change_a_bit(one_channel, beams):
    np.testing.assert_array_equal(_gather(one_channel, executor=in_threads(2)).images, beams.images)


def test_the_block_held_in_memory_hardly_changes_the_beams(one_channel, beams):
    got = _gather(one_channel, block=611).images
    np.testing.assert_allclose(got, beams.images, rtol=0, atol=1e-6 * beams.images.max())


def test_sources_of_one_cutout_and_direction_share_their_power(one_channel, beams):
    cutout = one_channel.plan.cutouts[0]
    assert beams.mixtures[1] == beams.mixtures[2]
    assert beams.power(1, cutout) is beams.power(2, cutout)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 999), st.integers(1, 30), st.floats(0.0, 0.05))
def test_every_source_has_a_direction_within_half_the_spacing_and_every_direction_a_source(
    seed, sources, width
):
    lm = np.random.default_rng(seed).uniform(-0.5, 0.5, (sources, 2)) * width
    nodes, nearest = directions(lm)
    assert np.all(np.abs(lm - nodes[nearest]) <= SPACING / 2 * (1 + 1e-9))
    np.testing.assert_array_equal(np.unique(nearest), np.arange(len(nodes)))


def test_a_pass_in_two_parts_gives_the_beams_of_one(one_channel, beams):
    response = one_channel.modelled(SKY).response
    plan = BeamPlan.around(SKY, response, 0.0, LONGEST, one_channel.plan.pixel)
    first, later = (BeamAccumulator(plan, response, GRIDDING) for _ in range(2))
    chunks = one_channel.in_pieces(2).blocks
    first.add(chunks[0])
    later.add(chunks[1])
    first.merge(later)
    np.testing.assert_array_equal(first.result().images, beams.images)


def test_a_mixture_adds_what_its_beams_have():
    quantities = np.random.default_rng(1).uniform(size=(3, 4)).astype(np.float32)
    mixture = Mixture.from_shares((0, 1, 2), np.array([0.7, 1e-9, -0.4]))
    assert mixture.beams == (0, 2)
    np.testing.assert_allclose(
        mixture.mixed(quantities.__getitem__), 0.7 * quantities[0] - 0.4 * quantities[2], rtol=1e-6
    )
    alone = Mixture.from_shares((1,), np.ones(1))
    assert np.shares_memory(alone.mixed(quantities.__getitem__), quantities)
