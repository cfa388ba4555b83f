"""Transforms of real images against numpy."""

import numpy as np
import pytest

from uvshear.numerics.real_transforms import half_spectrum, image_into, images_of


@pytest.mark.parametrize("size", [32, 90, 352])
@pytest.mark.parametrize(("dtype", "allowed"), [(np.float32, 2e-6), (np.float64, 1e-14)])
def test_transforms_are_those_of_numpy(size, dtype, allowed):
    image = np.random.default_rng(size).normal(size=(size, size)).astype(dtype)
    kept = image.copy()
    spectrum = half_spectrum(image)
    expected = np.fft.rfft2(image.astype(float))
    assert spectrum.dtype == np.result_type(dtype, np.complex64)
    np.testing.assert_allclose(spectrum, expected, rtol=0, atol=allowed * size)
    back = images_of(np.stack([spectrum, 2 * spectrum]), size)
    np.testing.assert_allclose(back, np.stack([image, 2 * image]), rtol=0, atol=20 * allowed)
    np.testing.assert_array_equal(image, kept)
    into = np.empty((3, size, size), dtype)[1]
    image_into(spectrum, into)
    np.testing.assert_allclose(into, image, rtol=0, atol=10 * allowed)
