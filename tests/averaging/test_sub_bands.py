"""Sub-bands."""

import numpy as np
import pytest

from uvshear.averaging.sub_bands import RATIO, SubBand
from uvshear.constants import SPEED_OF_LIGHT


def test_every_channel_is_in_one_sub_band_and_near_its_middle() -> None:
    frequency = np.geomspace(0.35e9, 15e9, 1001)
    bands = SubBand.of_channels(frequency)
    chosen = [band.channels(frequency) for band in bands]
    np.testing.assert_array_equal(np.sort(np.concatenate(chosen)), np.arange(1001))
    for band, channels in zip(bands, chosen, strict=True):
        ratio = frequency[channels] / band.frequency
        assert ratio.max() <= band.highest * (1 + 1e-12)
        assert ratio.min() >= 1 / band.highest * (1 - 1e-12)
        assert band.metres * band.frequency == pytest.approx(SPEED_OF_LIGHT)


def test_an_octave_has_eight_or_nine() -> None:
    for low in np.geomspace(0.5e9, 0.5e9 * RATIO, 7):
        assert len(SubBand.of_channels(np.linspace(low, 2 * low, 500))) in {8, 9}


def test_the_sub_bands_of_some_channels_are_among_those_of_all() -> None:
    frequency = np.linspace(856e6, 1712e6, 128)
    assert set(SubBand.of_channels(frequency[40:60])) <= set(SubBand.of_channels(frequency))
