"""Visits of the visibilities against direct sums over them."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from tests.extraction import visits
from tests.extraction.converged.major_cycles import (
    GRIDDING,
    LONGEST,
    MIXED,
    SKY,
    changed,
    nothing,
    visit,
)
from tests.reference import visit as reference
from uvshear.constants import ARCSEC
from uvshear.execution import in_threads
from uvshear.extraction.converged.major_cycle import (
    blocks,
    gather_residuals,
    predict_samples,
    slabs,
)
from uvshear.extraction.converged.plan import Wanted, plan_visit
from uvshear.imaging import tiles
from uvshear.interferometer.samples import Samples
from uvshear.predict import predict_visibilities
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template

CHANNELS = np.array([1.05e9, 1.2e9, 1.4e9])


@pytest.fixture(scope="module", autouse=True)
def _small_tiles():
    """Four tiles and more in the finest band, where one would do."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tiles, "CORE", 600)
        yield


@pytest.fixture(scope="module")
def one_channel():
    return visit()


@pytest.fixture(scope="module")
def channels():
    return visit(MIXED, CHANNELS, rows=500)


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


def test_facets_of_one_wide_tile_are_the_direct_dirty_images_too(monkeypatch):
    monkeypatch.setattr(tiles, "CORE", 3072)
    one = visit()
    facets = one.residuals(nothing())
    assert [len(band) for band in one.plan.tiles] == [1, 1]
    for source in (0, 2):
        expected = _direct(one.seen, one.seen.stokes_i, SKY, one.plan, source)
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
    left = seen.stokes_i - predict_visibilities(model, seen.uvw, seen.frequency, visits.PROFILE)
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


def test_channels_add_up_with_the_common_spectrum_as_matched_filter(channels):
    facets = channels.residuals(nothing(MIXED))
    expected = _direct(channels.seen, channels.seen.stokes_i, MIXED, channels.plan, 1)
    # without the filter: 0.1
    assert _error(facets[1], expected) < 4e-5


@pytest.mark.parametrize("case", ["one_channel", "channels"])
def test_samples_of_a_band_are_the_direct_sum_over_galaxies(case, request):
    one = request.getfixturevalue(case)
    sky = SKY if case == "one_channel" else MIXED
    exact = predict_visibilities(sky, one.seen.uvw, one.seen.frequency, visits.PROFILE)
    for band, on_sky in zip(one.plan.bands, one.plan.tiles, strict=True):
        samples = Samples.from_visibilities(
            one.seen.with_stokes_i(exact), band.shortest, band.longest
        )
        got = predict_samples(samples, on_sky, band, one.modelled(sky), GRIDDING)
        assert len(samples) > 100
        # measured 2e-5 of the summed flux
        np.testing.assert_allclose(got, samples.stokes_i, rtol=0, atol=6e-5 * sky.flux.sum())


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


def test_baselines_below_the_least_take_no_part(monkeypatch):
    monkeypatch.setattr(tiles, "CORE", 3072)
    shortest = 0.2 * LONGEST
    one = visit(shortest=shortest, rows=800)
    facets = one.residuals(nothing())
    cells = one.plan.cutouts[0]
    assert np.hypot(*cells.uv.T).min() >= shortest
    expected = _direct(one.seen, one.seen.stokes_i, SKY, one.plan, 0, (shortest, LONGEST))
    assert _error(facets[0], expected) < 6e-5  # measured 2e-5; the shortest baselines: 1


def test_without_the_longest_baselines_facets_are_cut_from_coarser_images(one_channel):
    whole = one_channel.plan
    reach = whole.bands[0].shortest
    count = len(SKY)
    wanted = Wanted(SKY.l, SKY.m, np.full(count, visits.WIDTH), np.full(count, LONGEST))
    plan = plan_visit(wanted, 0.0, reach, LONGEST)
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
        model = Template(plan.cutouts[source].uv, visits.PROFILE).model(
            GalaxyFit(1.0, np.array([2e-6, -3e-6]), 0.3 + 0.2j, 2 * ARCSEC, 1.0)
        )
        got, true = (np.sum((one * model.conj()).real) for one in (facets[source], expected))
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
    assert len(steps) == sum(len(band) for band in one_channel.plan.tiles)
    assert work(2) == steps


@pytest.mark.parametrize("size", [1, 137, 1500, 10_000])
def test_blocks_are_of_the_size_asked_for_but_the_last(one_channel, size):
    rows = 60 if size == 1 else 1500
    part = one_channel.in_pieces(1500 // rows).blocks[0]
    observation = replace(one_channel.observation, blocks=(part,))
    held = list(blocks(observation, 0.0, LONGEST, size))
    assert all(len(block) == size for block in held[:-1])
    assert 0 < len(held[-1]) <= size
    joined, whole = Samples.join(held), Samples.from_visibilities(part, 0.0, LONGEST)
    np.testing.assert_array_equal(joined.uvw, whole.uvw)
    np.testing.assert_array_equal(joined.stokes_i, whole.stokes_i)


@pytest.mark.parametrize("samples", [0, 1, 2**21, 2**21 + 1, 5 * 2**21 + 3])
def test_slabs_divide_the_samples_evenly(samples):
    parts = slabs(samples)
    lengths = [part.stop - part.start for part in parts]
    assert sum(lengths) == samples
    assert max(lengths) <= 2**21
    assert max(lengths) - min(lengths) <= 1
    assert all(a.stop == b.start for a, b in pairwise(parts))
