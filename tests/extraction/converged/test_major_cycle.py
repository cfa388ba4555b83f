"""Facets of a major cycle against direct sums over the visibilities."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.major_cycles import (
    GRIDDING,
    LONGEST,
    MIXED,
    PROFILE,
    SKY,
    WIDTH,
    changed,
    nothing,
    small_field,
)
from tests.io.measurement_sets import written
from tests.reference import visit as reference
from uvshear.constants import ARCSEC
from uvshear.execution import Copies, Dask, Serial, Threads, in_threads
from uvshear.extraction.converged.beams import BeamPlan
from uvshear.extraction.converged.major_cycle import (
    CyclePass,
    CycleSums,
    ResidualAccumulator,
    gather_residuals,
)
from uvshear.extraction.converged.plan import FacetRequests, plan_major_cycle
from uvshear.imaging.tiles import Tiling
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.held_observation import blocks_of, held_by_parts
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.predict import predict_visibilities
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template

CHANNELS = np.array([1.05e9, 1.2e9, 1.4e9])


@pytest.fixture(scope="module")
def one_channel():
    return small_field()


@pytest.fixture(scope="module")
def channels():
    return small_field(MIXED, CHANNELS, rows=500)


def _direct(seen, vis, model, plan, source, uv_range=(0.0, LONGEST)):
    """Facet of one source for visibilities from which the model is subtracted already."""
    index = np.median(model.spectral_index)
    return reference.residual_facet(
        seen,
        vis,
        (seen.frequency / 1.4e9) ** index,
        plan.cutouts[source],
        plan.place[source] * plan.pixel,
        plan.offset[source],
        uv_range,
    )


def _error(got, expected):
    return float(np.linalg.norm(got - expected) / np.linalg.norm(expected))


def test_the_field_of_these_tests_has_several_bands_and_tiles(one_channel):
    assert [len(band) for band in one_channel.plan.tiles] == [4, 1]


def test_facets_without_a_model_are_the_direct_dirty_images_at_their_places(one_channel):
    facets = one_channel.residuals(nothing())
    for source in (0, 1):
        expected = _direct(
            one_channel.seen, one_channel.seen.stokes_i, SKY, one_channel.plan, source
        )
        # measured 7e-5, the w that small tiles leave out; a band left out: 0.3; a tile one pixel off: 1
        assert _error(facets[source], expected) < 2e-4


def test_facets_of_one_wide_tile_are_the_direct_dirty_images_too():
    field = small_field(width=3072)
    facets = field.residuals(nothing())
    assert [len(band) for band in field.plan.tiles] == [1, 1]
    for source in (0, 2):
        expected = _direct(field.seen, field.seen.stokes_i, SKY, field.plan, source)
        assert _error(facets[source], expected) < 3e-5  # measured 1e-5: interpolation between bands


def test_nothing_is_left_when_the_model_is_the_truth(one_channel):
    without, with_model = one_channel.residuals(nothing()), one_channel.residuals(SKY)
    for left, whole in zip(with_model, without, strict=True):
        # measured 2e-6; a galaxy that one band of baselines does not subtract: 0.1
        assert np.linalg.norm(left) < 1e-5 * np.linalg.norm(whole)


def test_what_a_wrong_model_leaves_is_the_direct_image_of_the_difference(one_channel):
    model = changed(SKY, 1, flux=0.5, ellipticity=0.2 + 0.1j, l=SKY.l[1] + 5e-6)
    facets = one_channel.residuals(model)
    seen = one_channel.seen
    left = seen.stokes_i - predict_visibilities(model, seen.uvw, seen.frequency, PROFILE)
    for source in (1, 2):
        expected = _direct(seen, left, model, one_channel.plan, source)
        assert (
            _error(facets[source], expected) < 1e-4
        )  # measured 2e-5: of the difference, not of the whole


def test_galaxies_of_other_spectral_indices_leave_nothing_over_several_channels(channels):
    without, with_model = channels.residuals(nothing(MIXED)), channels.residuals(MIXED)
    for left, whole in zip(with_model, without, strict=True):
        # measured 1e-5, the end of the expansion; with one index for all: 0.1
        assert np.linalg.norm(left) < 5e-5 * np.linalg.norm(whole)


def test_channels_add_up_with_the_spectrum_of_each_source_as_matched_filter(channels):
    facets = channels.residuals(nothing(MIXED))
    strengths = channels.modelled(MIXED).response.strengths(MIXED)
    for source in (0, 1, 4):
        index = MIXED.spectral_index[source]
        own = replace(MIXED, spectral_index=np.full(len(MIXED), index))
        expected = _direct(channels.seen, channels.seen.stokes_i, own, channels.plan, source)
        # with the median of the spectra as filter: 0.04
        assert _error(facets[source], expected / strengths[source]) < 1e-4  # measured 4e-5


@pytest.mark.parametrize("threads", [2, 3])
def test_threads_do_not_change_a_bit(one_channel, threads):
    model = changed(SKY, 1, flux=0.5)
    alone = one_channel.residuals(model)
    together = one_channel.residuals(model, replace(GRIDDING, executor=in_threads(threads)))
    for a, b in zip(alone, together, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("pieces", [2, 7])
def test_how_the_rows_are_read_does_not_change_a_bit(one_channel, pieces):
    model = one_channel.modelled(changed(SKY, 1, flux=0.5))
    whole = gather_residuals(one_channel.observation, one_channel.plan, model, GRIDDING)
    parts = gather_residuals(one_channel.in_pieces(pieces), one_channel.plan, model, GRIDDING)
    for a, b in zip(whole, parts, strict=True):
        np.testing.assert_array_equal(a, b)


def test_the_block_held_in_memory_hardly_changes_the_facets(one_channel):
    model = changed(SKY, 1, flux=0.5)
    whole = one_channel.residuals(model)
    parts = one_channel.residuals(model, replace(GRIDDING, block=611))
    for a, b in zip(whole, parts, strict=True):
        assert _error(a, b) < 1e-4  # measured 1e-5; the samples at the end of a block lost: 1e-2


def test_baselines_below_the_least_take_no_part():
    shortest = 0.2 * LONGEST
    field = small_field(shortest=shortest, rows=800, width=3072)
    facets = field.residuals(nothing())
    cells = field.plan.cutouts[0]
    assert np.hypot(*cells.uv.T).min() >= shortest
    expected = _direct(field.seen, field.seen.stokes_i, SKY, field.plan, 0, (shortest, LONGEST))
    assert _error(facets[0], expected) < 6e-5  # measured 2e-5; the shortest baselines: 1


def test_without_the_longest_baselines_facets_are_cut_from_coarser_images(one_channel):
    whole = one_channel.plan
    reach = whole.bands[0].shortest
    count = len(SKY)
    requests = FacetRequests(SKY.l, SKY.m, np.full(count, WIDTH), np.full(count, LONGEST))
    plan = plan_major_cycle(requests, 0.0, reach, LONGEST, tiling=Tiling(600))
    assert (whole.top, plan.top) == (0, 1)
    assert plan.pixel == whole.pixel
    facets = gather_residuals(
        one_channel.observation, plan, one_channel.modelled(nothing()), GRIDDING
    )
    for source in (0, 2):
        assert np.hypot(*plan.cutouts[source].uv.T).max() <= reach
        expected = _direct(
            one_channel.seen, one_channel.seen.stokes_i, SKY, plan, source, (0.0, reach)
        )
        # Sharp edges differ on coarser pixels, and a galaxy in the middle of the square does not see them.
        model = Template(plan.cutouts[source].uv, PROFILE).model(
            GalaxyFit(1.0, np.array([2e-6, -3e-6]), 0.3 + 0.2j, 2 * ARCSEC, 1.0)
        )
        got, true = (np.sum((facet * model.conj()).real) for facet in (facets[source], expected))
        assert got == pytest.approx(true, rel=3e-4)  # a pixel aside: 0.3


def test_the_work_reported_is_the_same_whatever_the_threads(one_channel):
    def work(threads):
        steps = []
        gather_residuals(
            one_channel.observation,
            one_channel.plan,
            one_channel.modelled(SKY),
            replace(GRIDDING, executor=in_threads(threads)),
            steps.append,
        )
        return steps

    steps = work(1)
    # Every tile is predicted and imaged, and in the end all samples have been counted once.
    assert len(steps) == 2 * sum(len(band) for band in one_channel.plan.tiles)
    used = sum(
        len(Samples.from_visibilities(seen, one_channel.plan.shortest, one_channel.plan.longest))
        for seen in one_channel.observation.chunks()
    )
    assert sum(steps) == pytest.approx(used)
    assert work(2) == steps


def test_a_pass_in_two_parts_gives_the_facets_of_one(one_channel):
    model = one_channel.modelled(changed(SKY, 1, flux=0.5))
    undivided, first, later = (
        ResidualAccumulator(one_channel.plan, model, GRIDDING) for _ in range(3)
    )
    (whole,) = accumulate(one_channel.observation, [undivided])
    chunks = one_channel.in_pieces(2).blocks
    first.add(chunks[0])
    later.add(chunks[1])
    first.merge(later)
    for facet, expected in zip(first.result(), whole, strict=True):
        np.testing.assert_array_equal(facet, expected)


@pytest.fixture(scope="module")
def in_file(tmp_path_factory, one_channel):
    """The visibilities of one channel in a file of several chunks, and in memory as they are read from it."""
    path = tmp_path_factory.mktemp("cycles") / "field.ms"
    written(path.parent)
    observed = MeasurementSet(path, memory=2**15)
    chunks = tuple(screened_chunks(observed))
    return observed, VisibilitySet(observed.phase_centre, chunks)


def _pass(one_channel, executor, block):
    sky = one_channel.modelled(SKY)
    beams = BeamPlan.around(SKY, sky.response, 0.0, LONGEST, one_channel.plan.pixel)
    gridding = replace(GRIDDING, executor=executor, block=block)
    return CyclePass(one_channel.plan, sky, gridding, beams)


def _bits(sums):
    return [*(facet.tobytes() for facet in sums.facets), sums.beams.images.tobytes()]


def test_all_executors_add_up_the_ranges_of_a_file_bit_by_bit(one_channel, in_file, client):
    observed, _ = in_file
    sums = {}
    for executor in (Serial(), Threads(2), Copies(2), Dask(client, Threads(2))):
        ranges = held_by_parts(observed, 1e9, samples=2000)
        assert len(blocks_of(ranges, 2000)) == 4
        sums[type(executor)] = _pass(one_channel, executor, 2000).over(ranges)
    for other in (Threads, Copies, Dask):
        assert _bits(sums[other]) == _bits(sums[Serial])


def test_ranges_of_a_file_have_the_facets_and_the_beams_of_the_whole(one_channel, in_file):
    observed, in_memory = in_file
    found = _pass(one_channel, Serial(), 2000).over(held_by_parts(observed, 1e9, samples=2000))
    expected = _pass(one_channel, Serial(), 10**6).over(in_memory)
    for facet, whole in zip(found.facets, expected.facets, strict=True):
        # measured 2e-5, the error of the gridder; a block left out: 0.5
        assert _error(facet, whole) < 1e-4
    assert _error(found.beams.images, expected.beams.images) < 1e-4
    assert _error(found.beams.wide, expected.beams.wide) < 1e-4


def test_sums_are_sent_as_they_are():
    sums = CycleSums(tuple(np.full(k, k + 1j, np.complex64) for k in (3, 1, 2)), None)
    received = pickle.loads(pickle.dumps(sums))
    for facet, expected in zip(received.facets, sums.facets, strict=True):
        np.testing.assert_array_equal(facet, expected)
    total = received.add(sums)
    np.testing.assert_array_equal(total.facets[0], 2 * sums.facets[0])
    assert pickle.loads(pickle.dumps(CycleSums((), None))).facets == ()
