import numpy as np
import pytest

from uvshear.reproduce.psf_moments import (
    APERTURES,
    AdaptiveGaussian,
    RoundGaussian,
    SizesInApertures,
    UnweightedDisc,
    UnweightedSquare,
    moments_within,
)

PIXEL = 0.1
OFFSET = (np.arange(200) - 100) * PIXEL


def _gaussian(sigma_l: float, sigma_m: float) -> np.ndarray:
    l, m = OFFSET[:, None], OFFSET[None, :]
    return np.exp(-(l**2) / (2 * sigma_l**2) - m**2 / (2 * sigma_m**2))


def test_moments_of_a_gaussian():
    ellipticity, size = moments_within(_gaussian(1.2, 0.8), PIXEL)
    assert ellipticity == pytest.approx(0.2, abs=1e-6)
    assert size == pytest.approx(1.2**2 + 0.8**2, rel=1e-6)


def test_windows_narrow_a_gaussian_as_they_should():
    _, size = RoundGaussian().moments(_gaussian(1.0, 1.0), PIXEL, 1.0)
    assert size == pytest.approx(1.0, rel=1e-6)  # two Gaussians of variance 1 have 1/2 in each axis
    _, adaptive = AdaptiveGaussian().moments(_gaussian(1.0, 1.0), PIXEL, 1.0)
    assert adaptive == pytest.approx(size, rel=1e-4)


@pytest.mark.parametrize(
    ("aperture", "expected"), [(UnweightedDisc(), 0.5 * 4.0), (UnweightedSquare(), 2 / 3 * 4.0)]
)
def test_moments_of_a_plateau_are_those_of_the_window(aperture, expected):
    _, size = aperture.moments(np.ones((200, 200)), PIXEL, 2.0)
    assert size == pytest.approx(expected, rel=0.06)  # a pixel of 0.1 at the edge


@pytest.mark.parametrize("aperture", APERTURES, ids=lambda aperture: aperture.name)
def test_moments_that_are_not_positive_are_nan(aperture):
    image = -_gaussian(1.0, 1.0)
    image[100, 100] = 10 * abs(image.sum())  # a positive sum with negative moments
    ellipticity, size = aperture.moments(image, PIXEL, 3.0)
    assert np.isnan(size)
    assert np.isnan(ellipticity.real)


def test_the_width_of_a_size_is_interpolated():
    sizes = SizesInApertures(np.array([1.0, 2.0, 3.0]), np.array([1.0, 4.0, 9.0]))
    assert sizes.width_of(2.5) == pytest.approx(1.5)
    assert np.isnan(sizes.width_of(10.0))
    assert np.isnan(sizes.width_of(0.5))
