"""Odd channels and correlations."""

import numpy as np
import pytest

from uvshear.interferometer.spectral_window import Channels
from uvshear.io.spectral_oddities import spectral_oddities

CHANNELS = Channels(frequency=np.array([1.0e9, 1.1e9, 1.2e9]), width=np.full(3, 1e8))


def test_usual_channels_have_none():
    assert spectral_oddities(CHANNELS, CHANNELS.width, None) == ()
    assert spectral_oddities(CHANNELS, np.zeros(3), None) == ()


@pytest.mark.parametrize(("step", "overlaps"), [(0.51e8, False), (0.49e8, True), (0.0, True)])
def test_channels_closer_than_half_of_their_width_overlap(step, overlaps):
    frequency = np.array([1.0e9 + step, 1.2e9, 1.0e9])
    told = spectral_oddities(Channels(frequency, CHANNELS.width), np.zeros(3), None)
    assert len(told) == overlaps


def test_each_fact_is_a_sentence():
    told = spectral_oddities(CHANNELS, np.array([1e8, 2.67e8, 5e8]), "YY")
    assert told == (
        "YY alone is taken as Stokes I, as there is no other parallel hand",
        "channels are averages over more than 4 times their widths, by their effective widths",
    )
    assert spectral_oddities(CHANNELS, np.array([1e8, 2.67e8, 3.9e8]), None) == ()


@pytest.mark.parametrize(("last", "is_told"), [(2.29e9, False), (2.31e9, True), (4.8e9, True)])
def test_a_gap_of_four_times_the_band_is_told(last, is_told):
    channels = Channels(np.array([1.0e9, last, 1.1e9]), CHANNELS.width)
    told = spectral_oddities(channels, CHANNELS.width, None)
    assert len(told) == is_told
    if last == 4.8e9:
        assert told[0].startswith("a gap of 3700 MHz divides channels that are 300 MHz wide")


def test_one_channel_has_no_gap():
    channels = Channels(np.array([1.0e9]), np.array([1e6]))
    assert spectral_oddities(channels, np.zeros(1), None) == ()


def test_averages_beside_samples_are_told():
    told = spectral_oddities(CHANNELS, np.array([1e8, 0.0, 0.0]), None)
    assert told == (
        "some channels are averages over a band and others are not, by their effective widths",
    )
