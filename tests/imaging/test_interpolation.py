import numpy as np
import pytest

from uvshear.imaging.interpolation import add_refined
from uvshear.imaging.tiles import TAPS


def refined(coarse, shift, size):
    """Interpolate onto a square that is not empty."""
    fine = np.full((size, size), 2.0, np.float32)
    add_refined(fine, coarse, shift)
    return fine - 2.0


def _waves(x, y, highest, seed=3, number=40):
    """Sum of plane waves up to ``highest`` turns a pixel, at places ``x``, ``y`` [coarse pixels]."""
    rng = np.random.default_rng(seed)
    radius, angle = highest * np.sqrt(rng.uniform(size=number)), rng.uniform(0, 2 * np.pi, number)
    radius[:4] = highest
    phase = rng.uniform(0, 2 * np.pi, number)
    k, l = radius * np.cos(angle), radius * np.sin(angle)
    turns = k[:, None, None] * x[:, None] + l[:, None, None] * y[None, :]
    return np.cos(2 * np.pi * turns + phase[:, None, None]).sum(axis=0)


# Nyquist over the highest frequency, error in rms allowed (measured: 2.8e-5, 1.8e-5)
@pytest.mark.parametrize(("oversampling", "allowed"), [(1.6, 4e-5), (2.5, 2.5e-5)])
@pytest.mark.parametrize("shift", [(17, 20), (24, 31), (40, 16)])
def test_an_image_that_oversamples_is_the_same_waves_on_finer_pixels(oversampling, allowed, shift):
    highest = 0.5 / oversampling
    coarse = np.arange(60.0)
    image = _waves(coarse, coarse, highest).astype(np.float32)
    fine = [(s + np.arange(40)) / 2 for s in shift]
    expected = _waves(*fine, highest)
    got = refined(image, shift, 40)
    # half a pixel off: 1; axes exchanged: 1.4; a bilinear interpolation: 0.3
    assert np.sqrt(np.mean((got - expected) ** 2)) < allowed * np.sqrt(np.mean(expected**2))


def test_pixels_that_both_have_keep_their_values():
    image = np.random.default_rng(1).normal(size=(40, 40)).astype(np.float32)
    got = refined(image, (20, 22), 30)
    np.testing.assert_allclose(got[::2, ::2], image[10:25, 11:26], rtol=0, atol=2e-6)


@pytest.mark.parametrize("shift", [(2 * TAPS - 3, 20), (20, 60)])
def test_a_coarse_image_that_does_not_reach_far_enough_is_refused(shift):
    with pytest.raises(ValueError, match="does not cover"):
        refined(np.ones((40, 40), np.float32), shift, 30)
