"""Patches of the sky with equal numbers of sources."""

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.estimators.patches import sky_patches


@pytest.mark.parametrize("count", [2, 3, 7, 16, 100])
def test_every_patch_has_its_share_of_the_sources(count):
    l, m = np.random.default_rng(1).uniform(-1, 1, (2, 1000))
    _, numbers = np.unique(sky_patches(l, m, count), return_counts=True)
    assert len(numbers) == count
    assert numbers.min() >= 1000 // count - 1
    assert numbers.max() <= 1000 // count + 1


def test_patches_are_compact():
    """Sixteen patches of a square, a quarter of its side wide."""
    l, m = np.random.default_rng(2).uniform(-1, 1, (2, 4000))
    patch = sky_patches(l, m, 16)
    widths = [np.ptp(axis[patch == k]) for k in range(16) for axis in (l, m)]
    assert max(widths) < 0.65


def test_a_long_field_is_divided_along_its_length():
    l, m = np.linspace(-1, 1, 90), np.tile([0.0, 0.01, 0.02], 30)
    np.testing.assert_array_equal(sky_patches(l, m, 3), np.repeat([0, 1, 2], 30))


def test_the_order_of_the_sources_does_not_matter():
    rng = np.random.default_rng(3)
    l, m = rng.uniform(-1, 1, (2, 300))
    order = rng.permutation(300)
    np.testing.assert_array_equal(sky_patches(l[order], m[order], 10), sky_patches(l, m, 10)[order])


@pytest.mark.parametrize("count", [1, 6])
def test_patches_without_sources_are_refused(count):
    with pytest.raises(InputError, match=f"{count} patches of the sky for 5 sources"):
        sky_patches(np.arange(5.0), np.zeros(5), count)
