"""Products of functions of w and of the position, against the exponential that they stand for."""

import numpy as np
import pytest

from uvshear.imaging.grid import ImageGrid
from uvshear.imaging.w_terms import IN_THE_TAIL, WTerms, number_of_terms

SIZE = 256


def _image(pixel=4e-6):
    return ImageGrid(SIZE, pixel)


def _w(phase, image, samples=3000, seed=1):
    """Return w with which the corner of an image is turned by up to a phase [rad]."""
    largest = phase / (np.pi * 2 * (image.size * image.pixel / 2) ** 2)
    w = largest * np.clip(np.random.default_rng(seed).normal(size=samples) / 2, -1, 1)
    w[0] = largest
    return w


def _sum(terms, w):
    """Return the sum of products for each w over the whole image, as it is applied to visibilities."""
    ones = np.ones((SIZE, SIZE), np.float32)
    total = np.zeros((len(w), SIZE, SIZE), complex)
    for k in range(len(terms)):
        factor = np.zeros(len(w), np.complex64)
        terms.add_weighted(k, w, np.ones(len(w), np.complex64), factor)
        total += factor[:, None, None] * terms.image(k, ones)
    return total


def _exact(w, image):
    x = (np.arange(SIZE) - SIZE // 2) * image.pixel
    n1 = np.sqrt(1 - x[:, None] ** 2 - x**2) - 1
    return np.exp(2j * np.pi * w[:, None, None] * n1)


@pytest.mark.parametrize("pixel", [4e-6, 2e-3])  # the second reaches 20 degrees from the centre
@pytest.mark.parametrize("error", [1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("phase", [0.0, 0.1, 0.5, 1.0])
def test_the_error_is_the_one_that_is_allowed(phase, error, pixel):
    image = _image(pixel)
    w = _w(phase, image)
    terms = WTerms.within(w, image, error)
    few = np.append(w[:: len(w) // 60], w[0])
    wrong = np.abs(_sum(terms, few) - _exact(few, image))
    # The largest w is one of the few, but hardly counts among all.
    assert np.sqrt(np.mean(wrong[:-1] ** 2)) < 1.1 * error + 3e-7
    assert np.sqrt(np.mean(wrong**2, axis=(1, 2))).max() < 1.1 * IN_THE_TAIL * error + 3e-7


def test_the_number_of_products_grows_with_the_phase():
    image = _image()
    numbers = [len(WTerms.within(_w(phase, image), image, 1e-4)) for phase in (0, 0.1, 0.5, 1, 1.6)]
    assert numbers == [1, 2, 3, 4, 5]


def test_without_w_the_only_product_is_one():
    terms = WTerms.within(np.zeros(10), _image(), 1e-5)
    assert len(terms) == 1
    np.testing.assert_allclose(_sum(terms, np.zeros(2)), 1, rtol=1e-6)


def test_weighted_visibilities_are_the_adjoint():
    image = _image()
    w = _w(1.0, image)
    terms = WTerms.within(w, image, 1e-5)
    rng = np.random.default_rng(2)
    vis, other = (
        (rng.normal(size=len(w)) + 1j * rng.normal(size=len(w))).astype(np.complex64)
        for _ in range(2)
    )
    for k in range(len(terms)):
        seen = np.zeros_like(other)
        terms.add_weighted(k, w, other, seen)
        left, right = np.vdot(terms.weighted(k, w, vis), other), np.vdot(vis, seen)
        assert left == pytest.approx(right, rel=1e-5)


@pytest.mark.parametrize(
    ("phase", "samples", "has_terms"),
    [
        (7.0, 1000, False),  # too large a phase
        (1.0, 1000, True),  # four products; the images cost most
        (1.0, 1_000_000, False),  # the samples cost most
        (0.2, 1_000_000, True),  # two products
    ],
)
def test_w_planes_are_used_where_they_cost_less(phase, samples, has_terms):
    image = _image()
    assert (WTerms.within(_w(phase, image, samples), image, 1e-4) is not None) is has_terms


def test_the_number_of_products_is_known_from_a_few_samples():
    image = _image()
    for phase in (0.1, 1.0):
        w = _w(phase, image, samples=5000)
        terms = WTerms.within(w, image, 1e-4)
        assert number_of_terms(w[::10], image, 1e-4, len(w)) == len(terms)
    # With so many samples, w-planes are cheaper; without any, a single image is enough.
    assert number_of_terms(w[::10], image, 1e-4, 10**7) is None
    assert number_of_terms(w[:0], image, 1e-4, 0) == 1
    assert number_of_terms(_w(20.0, image), image, 1e-4, 100) is None
