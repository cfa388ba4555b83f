"""The images of a field before and after its sky is taken away."""

import numpy as np
import pytest

from tests.reference import dirty
from tests.skies import galaxies, random_baselines
from uvshear.constants import ARCSEC
from uvshear.diagnostics import residual_image
from uvshear.diagnostics.residual_image import ResidualImageAccumulator, plan_image
from uvshear.errors import InputError
from uvshear.execution import in_threads
from uvshear.galaxy import Exponential
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.summary import summarise
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict import gridded, predict_visibilities
from uvshear.predict.gridded import Gridding

FREQUENCY = np.array([1.2e9, 1.5e9])
SKY = galaxies(
    l=[0.02, -0.013, 0.004, 0.0041, -0.0006],
    m=[0.011, 0.018, -0.016, -0.0155, 0.0],
    flux=[2e-3, 1e-3, 3e-3, 5e-4, 1e-3],
    alpha=np.array([5.0, 9.0, 3.0, 0.0, 20.0]) * ARCSEC,
    e=[0.3 + 0.2j, -0.5j, 0.1, 0.0, 0.6],
    beta=[-0.7, -0.7, 0.4, -1.5, -0.7],
)
NOTHING = galaxies(flux=0.0)


def _observe(sky, noise=0.0, rows=3000, more=NOTHING, depth=0.5):
    """Weights differ a hundredfold; w is up to half the longest baseline: a turn at the outermost source."""
    rng = np.random.default_rng(1)
    uvw = random_baselines(rows, 1.5e3, depth=depth)
    vis = sum(predict_visibilities(part, uvw, FREQUENCY) for part in (sky, more))
    weights = 10 ** rng.uniform(6, 8, vis.shape)
    normal = rng.normal(size=(2, *vis.shape))
    vis = vis + noise * (normal[0] + 1j * normal[1]) / np.sqrt(weights)
    half = rows // 2
    parts = (slice(half), slice(half, None))
    blocks = [Visibilities(uvw[part], FREQUENCY, vis[part], weights[part]) for part in parts]
    return VisibilitySet(PhaseCentre(1.0, 0.5), tuple(blocks))


def _image(observation, sky, **more):
    summary = summarise(observation)
    return residual_image.residual_image(observation, sky, Exponential(), summary=summary, **more)


def _rms(x):
    return float(np.sqrt(np.mean(np.square(x, dtype=float))))


def test_of_a_sky_that_is_known_thermal_noise_is_left():
    observation = _observe(SKY, noise=1.0)
    images = _image(observation, SKY)
    weight = sum(float(block.weights.sum()) for block in observation.blocks)
    assert images.weight == pytest.approx(weight, rel=1e-6)
    assert images.samples == 6000
    assert images.noise == pytest.approx(weight**-0.5, rel=1e-6)
    # measured 0.989; divided by the number of samples, or weights unused: 2.2 and more
    assert images.rms == pytest.approx(images.noise, rel=0.03)
    assert _rms(images.dirty) > 10 * images.noise


def test_a_source_that_the_sky_lacks_stands_at_its_place_with_its_flux():
    longest = summarise(_observe(NOTHING)).longest
    grid, _ = plan_image(SKY, UvRange(), longest)
    i, j = grid.size // 2 + 400, grid.size // 2 - 230
    l, m = (place * grid.pixel - grid.size // 2 * grid.pixel for place in (i, j))
    images = _image(_observe(SKY, more=galaxies(l, m, 4e-3, alpha=0.0, beta=0.0)), SKY)
    assert images.grid == grid
    # measured 1e-7; without w-planes it is gone; l and m exchanged or mirrored, nothing stands there
    assert images.residual[i, j] == pytest.approx(4e-3, rel=1e-3)
    assert np.unravel_index(images.residual.argmax(), images.residual.shape) == (i, j)


@pytest.mark.parametrize("direct", [0, 1e12])
def test_models_are_subtracted_by_tiles_as_by_the_direct_sum(monkeypatch, direct):
    monkeypatch.setattr(residual_image, "DIRECT", direct)
    images = _image(_observe(SKY), SKY)
    # measured 1.3e-4 by tiles, 8e-6 directly; without the spectrum: 0.08
    assert _rms(images.residual) < 2e-4 * _rms(images.dirty)


def test_large_galaxies_are_subtracted_to_where_they_end(monkeypatch):
    """Without w, whose second order across such a galaxy is in the tiles and not in the direct sum."""
    monkeypatch.setattr(residual_image, "DIRECT", 0)
    alpha = np.array([60.0, 100.0]) * ARCSEC
    large = galaxies([0.005, -0.01], [0.002, -0.004], [2e-3, 1e-3], alpha, [0.3 + 0.2j, -0.2j])
    images = _image(_observe(large, depth=0.0), large)
    # measured 8e-7; drawn to half as far: 5e-4
    assert _rms(images.residual) < 5e-6 * _rms(images.dirty)


def test_the_images_are_the_direct_sums():
    observation = _observe(SKY, noise=1.0, rows=400)
    part = SKY.select(slice(3))
    images = _image(observation, part)
    grid = images.grid
    place = np.random.default_rng(3).integers(0, grid.size, (40, 2))
    l, m = ((place - grid.size // 2) * grid.pixel).T
    uvw, vis, weights = (
        np.concatenate([getattr(block, x) for block in observation.blocks])
        for x in ("uvw", "stokes_i", "weights")
    )
    left = vis - predict_visibilities(part, uvw, FREQUENCY)
    for image, data in ((images.dirty, vis), (images.residual, left)):
        expected = dirty.dirty_image(uvw, FREQUENCY, data, weights, l, m) / weights.sum()
        np.testing.assert_allclose(image[tuple(place.T)], expected, atol=3e-4 * _rms(expected))


def test_every_source_is_on_the_image_with_a_margin():
    for longest in (50.0, 3e3, 1e5, 1e7):
        grid, used = plan_image(SKY, UvRange(), longest)
        assert grid.size % 2 == 0
        assert grid.size <= residual_image.MOST_PIXELS
        assert grid.size * grid.pixel / 2 >= 0.0219
        assert used.maximum <= min(longest, 1 / (2.4 * grid.pixel)) * (1 + 1e-12)


def test_pixels_are_no_finer_than_the_longest_baseline_needs():
    grid, used = plan_image(SKY, UvRange(), 1e4)
    assert grid.pixel == pytest.approx(1 / 3e4)
    assert used.maximum == 1e4
    grid, used = plan_image(SKY, UvRange(0, 5e3), 1e4)
    assert grid.pixel == pytest.approx(1 / 1.5e4)
    assert used.maximum == 5e3


def test_baselines_that_the_pixels_cannot_carry_are_left_out(monkeypatch):
    monkeypatch.setattr(residual_image, "MOST_PIXELS", 256)
    observation = _observe(SKY, noise=1.0)
    images = _image(observation, SKY)
    carried = 1 / (2.4 * images.grid.pixel)
    assert images.grid.size == 256
    assert images.uv_range.maximum == pytest.approx(carried)
    kept = [block.weights[block.uv_distance < carried] for block in observation.blocks]
    assert images.samples == sum(len(weights) for weights in kept) < 6000
    assert images.weight == pytest.approx(sum(weights.sum() for weights in kept), rel=1e-6)
    assert images.rms == pytest.approx(images.noise, rel=0.05)


def test_the_uv_range_is_heeded():
    observation = _observe(SKY)
    images = _image(observation, SKY, uv_range=UvRange(1000.0, 4000.0))
    kept = [
        block.uv_distance[(block.uv_distance >= 1000) & (block.uv_distance < 4000)]
        for block in observation.blocks
    ]
    assert images.samples == sum(map(len, kept))


def test_a_uv_range_beyond_what_pixels_carry_is_refused():
    with pytest.raises(InputError, match="--uv-min 9e\\+06: a residual image of 4096 pixels"):
        plan_image(SKY, UvRange(9e6), 1e7)


def test_bits_do_not_depend_on_the_threads(monkeypatch):
    monkeypatch.setattr(gridded, "SLAB", 2250)
    monkeypatch.setattr(residual_image, "DIRECT", 0)
    observation = _observe(SKY, noise=1.0)
    one, three = (
        _image(observation, SKY, gridding=Gridding(block=4500, executor=in_threads(threads)))
        for threads in (1, 3)
    )
    np.testing.assert_array_equal(one.residual, three.residual)
    np.testing.assert_array_equal(one.dirty, three.dirty)


def test_without_a_sky_the_residual_is_the_dirty_image():
    images = _image(_observe(SKY), NOTHING)
    np.testing.assert_array_equal(images.dirty, images.residual)


def test_every_sample_is_heard_of_three_times():
    heard = []
    _image(_observe(SKY), SKY, step=heard.append)
    assert sum(heard) == 3 * 6000


def test_a_pass_in_two_parts_gives_the_images_of_one():
    observation = _observe(SKY)
    grid, used = plan_image(SKY, UvRange(), summarise(observation).longest)
    first, later = (ResidualImageAccumulator(grid, used, None, Gridding()) for _ in range(2))
    first.add(observation.blocks[0])
    later.add(observation.blocks[1])
    first.merge(later)
    whole = _image(observation, SKY)
    got = first.result()
    assert got.samples == whole.samples
    assert got.weight == pytest.approx(whole.weight, rel=1e-6)
    np.testing.assert_allclose(got.dirty, whole.dirty, rtol=0, atol=1e-4 * _rms(whole.dirty))
