import numpy as np
import pytest

from uvshear.imaging.ring_means import ring_means

PIXEL = 0.25


def test_the_first_ring_is_the_central_pixel():
    image = np.zeros((16, 16))
    image[8, 8] = 3.0
    distance, mean = ring_means(image, PIXEL)
    assert distance[0] == 0
    assert mean.tolist() == [3.0] + [0.0] * 7


def test_the_mean_of_the_distance_is_the_distance():
    offset = (np.arange(32) - 16) * PIXEL
    image = np.hypot(offset[:, None], offset[None, :])
    distance, mean = ring_means(image, PIXEL)
    np.testing.assert_allclose(mean, distance, rtol=1e-12)


@pytest.mark.parametrize("fwhm", [4.0, 7.0])
def test_each_ring_has_the_mean_of_a_loop_over_all_pixels(fwhm):
    offset = np.arange(24) - 12
    image = np.exp(-np.hypot(offset[:, None], 1.3 * offset[None, :] + 0.2) / fwhm)
    _, mean = ring_means(image, PIXEL)
    for ring in range(12):
        pixels = [
            image[i, j]
            for i in range(24)
            for j in range(24)
            if ring - 0.5 < ((i - 12) ** 2 + (j - 12) ** 2) ** 0.5 <= ring + 0.5
        ]
        assert mean[ring] == pytest.approx(np.mean(pixels), rel=1e-12)
