import math

import numpy as np
import pytest

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.interferometer.psf_shape import fit_main_lobe, measure_psf
from uvshear.typing import Array

PIXEL = 0.2 * ARCSEC


def _gaussian(e: complex, sigma: float, size: int = 160) -> Array:
    """Gaussian of ellipticity e whose covariance has determinant sigma^4 [rad]."""
    modulus = abs(e) ** 2
    shape = np.array(
        [[1 + modulus + 2 * e.real, 2 * e.imag], [2 * e.imag, 1 + modulus - 2 * e.real]]
    )
    inverse = np.linalg.inv(shape / (1 - modulus) * sigma**2)
    x = (np.arange(size) - size // 2) * PIXEL
    l, m = x[:, None], x[None, :]
    return np.exp(-(inverse[0, 0] * l**2 + 2 * inverse[0, 1] * l * m + inverse[1, 1] * m**2) / 2)


@pytest.mark.parametrize("e", [0j, 0.3 + 0j, -0.2 + 0j, 0.25j, 0.1 - 0.2j])
def test_a_gaussian_has_its_own_ellipticity_and_the_size_of_the_product(e: complex) -> None:
    sigma, weight = 2 * ARCSEC, 3 * ARCSEC
    shape = measure_psf(_gaussian(e, sigma), PIXEL, weight)
    # weight and PSF have the same axes, so their product has variance 1/(1/sigma^2 + 1/weight^2)
    product = 1 / (1 / sigma**2 + 1 / weight**2)
    size = 2 * product * (1 + abs(e) ** 2) / (1 - abs(e) ** 2)
    assert (
        abs(shape.ellipticity - e) < 1e-6
    )  # the rounds stop at 1e-7; a factor 2 in e shows at 0.1
    assert shape.size == pytest.approx(size, rel=1e-6)


def test_e1_is_long_along_l() -> None:
    image = np.full((64, 64), 1e-9)
    image[20:45, 30:35] = 1.0  # the first axis is l
    assert measure_psf(image, PIXEL).ellipticity.real > 0.1


def test_an_image_without_moments_is_refused() -> None:
    with pytest.raises(InputError, match="second moments of the PSF are not positive"):
        measure_psf(-np.ones((32, 32)), PIXEL)


@pytest.mark.parametrize("e", [0j, 0.3 + 0j, 0.1 - 0.2j])
def test_the_main_lobe_of_a_gaussian_is_the_gaussian(e: complex) -> None:
    sigma = 2 * ARCSEC
    lobe = fit_main_lobe(_gaussian(e, sigma), PIXEL)
    assert abs(lobe.ellipticity - e) < 1e-6
    assert lobe.fwhm == pytest.approx(math.sqrt(8 * math.log(2)) * sigma, rel=1e-6)


def test_side_lobes_have_no_part_in_the_main_lobe() -> None:
    x = (np.arange(160) - 80) * PIXEL
    l, m = x[:, None], x[None, :]
    beside = np.exp(-((l - 12 * ARCSEC) ** 2 + m**2) / (2 * ARCSEC) ** 2)
    image = _gaussian(0.2 + 0j, 1 * ARCSEC) + 0.7 * beside
    assert abs(fit_main_lobe(image, PIXEL).ellipticity - 0.2) < 1e-6


def _block(rows: slice, columns: slice) -> Array:
    image = np.zeros((64, 64))
    image[rows, columns] = 1.0
    return image


@pytest.mark.parametrize(
    "image",
    [
        np.ones((64, 64)),
        _gaussian(0j, 0.1 * ARCSEC),
        _block(slice(27, 38), slice(32, 33)),
        _block(slice(31, 34), slice(31, 34)),
    ],
    ids=["everywhere", "one pixel", "a line", "a block"],
)
def test_a_lobe_that_is_not_in_the_image_is_refused(image: Array) -> None:
    with pytest.raises(InputError, match="change --pixel-arcsec, or enlarge the image"):
        fit_main_lobe(image, PIXEL)
