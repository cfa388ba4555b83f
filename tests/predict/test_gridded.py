"""Visibilities by way of images against the direct sum over galaxies."""

import weakref
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from tests.extraction.converged.major_cycles import GRIDDING, MIXED, PROFILE, SKY, small_field
from uvshear.errors import InputError
from uvshear.execution import SERIAL, Resources, in_threads
from uvshear.imaging import tiles
from uvshear.interferometer.samples import Samples
from uvshear.predict import gridded, predict_visibilities
from uvshear.predict.gridded import (
    BLOCK,
    BYTES_IN_FLIGHT,
    BYTES_PER_PIXEL,
    BYTES_PER_SAMPLE,
    Gridding,
    PredictedBand,
    predict_bands,
    predict_samples,
    slabs,
)
from uvshear.predict.rendering import render

CHANNELS = np.array([1.05e9, 1.2e9, 1.4e9])


@pytest.fixture(scope="module", autouse=True)
def _small_tiles():
    """Four tiles and more in the finest band, where one would do."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tiles, "WIDEST", 600)
        yield


@pytest.fixture(scope="module")
def one_channel():
    return small_field()


@pytest.fixture(scope="module")
def channels():
    return small_field(MIXED, CHANNELS, rows=500)


@pytest.mark.parametrize("case", ["one_channel", "channels"])
def test_samples_of_a_band_are_the_direct_sum_over_galaxies(case, request):
    field = request.getfixturevalue(case)
    sky = SKY if case == "one_channel" else MIXED
    exact = predict_visibilities(sky, field.seen.uvw, field.seen.frequency, PROFILE)
    for band, on_sky in zip(field.plan.bands, field.plan.tiles, strict=True):
        samples = Samples.from_visibilities(
            field.seen.with_stokes_i(exact), band.shortest, band.longest
        )
        got = predict_samples(samples, on_sky, band, field.modelled(sky), GRIDDING)
        assert len(samples) > 100
        # measured 2e-5 of the summed flux
        np.testing.assert_allclose(got, samples.stokes_i, rtol=0, atol=6e-5 * sky.flux.sum())


@pytest.mark.parametrize("executor", [SERIAL, in_threads(3)])
def test_bands_that_are_predicted_together_are_the_same_to_the_bit(one_channel, executor):
    bands = [
        PredictedBand(
            Samples.from_visibilities(one_channel.seen, band.shortest, band.longest), on_sky, band
        )
        for band, on_sky in zip(one_channel.plan.bands, one_channel.plan.tiles, strict=True)
    ]
    sky = one_channel.modelled(SKY)
    together = predict_bands(bands, sky, replace(GRIDDING, executor=executor))
    assert len(together) == len(bands) > 1
    for each, found in zip(bands, together, strict=True):
        alone = predict_samples(each.samples, each.tiles, each.band, sky, GRIDDING)
        np.testing.assert_array_equal(found, alone)


@pytest.mark.parametrize("samples", [0, 1, 2**21, 2**21 + 1, 5 * 2**21 + 3])
def test_slabs_divide_the_samples_evenly(samples):
    parts = slabs(samples)
    lengths = [part.stop - part.start for part in parts]
    assert sum(lengths) == samples
    assert max(lengths) <= 2**21
    assert max(lengths) - min(lengths) <= 1
    assert all(a.stop == b.start for a, b in pairwise(parts))


@pytest.mark.parametrize("memory", [2.1e9, 8e9, 64e9])
def test_blocks_do_not_depend_on_the_memory_which_limits_what_is_done_at_once(memory):
    gridding = Gridding.within(Resources(in_threads(16), memory), 10**9, 1e-5)
    assert gridding.epsilon == 1e-5
    assert gridding.block == BLOCK
    workers = gridding.executor_for(3000, 10**6).workers
    assert 1 <= workers <= 16
    # as many as fit, and at least one
    each = 3000**2 * BYTES_PER_PIXEL + 10**6 * BYTES_IN_FLIGHT
    of_images = memory - BLOCK * BYTES_PER_SAMPLE
    assert workers in (1, 16) or workers * each <= of_images < (workers + 1) * each
    assert gridding.executor_for(64, 1000).workers == 16


def test_memory_that_does_not_hold_a_block_is_refused():
    few = 1000
    assert Gridding.within(Resources(SERIAL, few * BYTES_PER_SAMPLE), few).block == BLOCK
    with pytest.raises(
        InputError, match=r"--memory-gb 0\.1 \(memory=\): 2\.02 GB or more are needed"
    ):
        Gridding.within(Resources(SERIAL, 1e8), 10**8)


def test_moments_of_averages_count_as_memory_of_a_block():
    resources = Resources(SERIAL, 8e9)
    plain, averages = (Gridding.within(resources, 10**9, moments=k) for k in (0, 21))
    # Two blocks hold them in single precision.
    assert plain.memory - averages.memory == 2 * BLOCK * 21 * np.float32().nbytes


def test_without_a_limit_all_workers_are_used():
    assert Gridding(executor=in_threads(5)).executor_for(10_000, 10**9).workers == 5


def test_the_image_of_a_tile_is_released_after_its_last_use(one_channel, monkeypatch):
    drawn: list[weakref.ref] = []
    alive = []

    def watched(*arguments):
        image = render(*arguments)
        drawn.append(weakref.ref(image))
        alive.append(sum(known() is not None for known in drawn))
        return image

    monkeypatch.setattr(gridded, "render", watched)
    band, on_sky = one_channel.plan.bands[0], one_channel.plan.tiles[0]
    samples = Samples.from_visibilities(one_channel.seen, band.shortest, band.longest)
    predict_samples(samples, on_sky, band, one_channel.modelled(SKY), GRIDDING)
    assert len(drawn) > 3
    # One is degridded, and the next is drawn ahead.
    assert max(alive) == 2
