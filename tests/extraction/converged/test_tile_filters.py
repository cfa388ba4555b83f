"""Mixtures of the images of a tile."""

import numpy as np

from tests.skies import galaxies
from uvshear.extraction.converged.tile_filters import TileFilters
from uvshear.imaging.tiles import Tile
from uvshear.interferometer.attenuation import BandwidthSmearing
from uvshear.interferometer.samples import Samples
from uvshear.predict.response import FILTER_TOLERANCE, Response, seen_as

COUNT = 40


def _probes(count=3000, seed=1):
    rng = np.random.default_rng(seed)
    frequency = rng.uniform(1.3e9, 1.5e9, count)
    return Samples(
        uvw=rng.normal(0, 4e4, (count, 3)) * (1, 1, 0.1),
        stokes_i=np.zeros(count, np.complex64),
        weights=np.ones(count, np.float32),
        frequency=frequency,
        bandwidth=np.full(count, 8e6, np.float32),
        interval=np.zeros(count, np.float32),
        antennas=np.zeros((count, 2), np.int16),
    )


def _tile(members):
    return Tile(0, (0, 0), 64, members, -1)


def _sky():
    rng = np.random.default_rng(2)
    return galaxies(rng.uniform(1e-3, 2e-3, COUNT), rng.uniform(0, 1e-3, COUNT), 1.0)


def test_a_mixture_of_images_is_the_image_with_the_sources_own_filter():
    """An image is linear in its filter, so that filters on samples stand for images here."""
    sky = _sky()
    response = Response.from_sky(sky, _probes(), BandwidthSmearing())
    members = np.arange(COUNT)[::-1][:30]
    matched = TileFilters.from_tile(_tile(members), sky, response, 0.0, np.inf)
    assert 1 < len(matched.chosen) < 20
    np.testing.assert_array_equal(matched.members, np.sort(members))
    others = _probes(400, seed=5)
    images = [response.matched_filter(others, *key)[:, None] for key in matched.seen_as]
    for source in members.tolist():
        own = response.matched_filter(others, *seen_as(sky, source))
        mixed = matched.mixed(images, source)[:, 0]
        assert np.sqrt(np.mean((mixed - own) ** 2)) < 3 * FILTER_TOLERANCE


def test_without_attenuation_there_is_one_image_and_it_is_not_copied():
    sky = _sky()
    matched = TileFilters.from_tile(_tile(np.arange(5)), sky, Response.from_sky(sky), 0.0, np.inf)
    image = np.ones((4, 4), np.float32)
    assert len(matched.seen_as) == 1
    assert matched.mixed([image], 3) is image
