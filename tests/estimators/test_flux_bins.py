"""Bins of flux."""

import numpy as np

from uvshear.estimators.flux_bins import FLUX_BINS


def test_bins_are_named_in_microjanskys():
    assert [flux_bin.name for flux_bin in FLUX_BINS] == ["10-20 uJy", "20-50 uJy", "50-200 uJy"]


def test_a_flux_is_in_one_bin_at_most():
    flux = np.array([9.99, 10, 19.99, 20, 49.9, 50, 199, 200]) * 1e-6
    inside = np.array([flux_bin.holds(flux) for flux_bin in FLUX_BINS]).T
    assert [np.flatnonzero(row).tolist() for row in inside] == [
        [],
        [0],
        [0],
        [1],
        [1],
        [2],
        [2],
        [],
    ]
