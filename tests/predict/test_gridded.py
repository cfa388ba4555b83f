"""Visibilities by way of images against the direct sum over galaxies."""

from itertools import pairwise

import numpy as np
import pytest

from tests.extraction.converged.major_cycles import GRIDDING, MIXED, PROFILE, SKY, small_field
from uvshear.imaging import tiles
from uvshear.interferometer.samples import Samples
from uvshear.predict import predict_visibilities
from uvshear.predict.gridded import (
    BYTES_PER_SAMPLE,
    LEAST_BLOCK,
    block_of,
    predict_samples,
    slabs,
)

CHANNELS = np.array([1.05e9, 1.2e9, 1.4e9])


@pytest.fixture(scope="module", autouse=True)
def _small_tiles():
    """Four tiles and more in the finest band, where one would do."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tiles, "CORE", 600)
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


@pytest.mark.parametrize("samples", [0, 1, 2**21, 2**21 + 1, 5 * 2**21 + 3])
def test_slabs_divide_the_samples_evenly(samples):
    parts = slabs(samples)
    lengths = [part.stop - part.start for part in parts]
    assert sum(lengths) == samples
    assert max(lengths) <= 2**21
    assert max(lengths) - min(lengths) <= 1
    assert all(a.stop == b.start for a, b in pairwise(parts))


def test_a_block_takes_a_third_of_the_memory_and_is_never_tiny():
    assert block_of(3e9) == 1e9 // BYTES_PER_SAMPLE
    assert block_of(1.0) == LEAST_BLOCK
