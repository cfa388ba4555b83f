"""Channels."""

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.interferometer.spectral_window import Channels


def test_channels_fill_the_band():
    channels = Channels.from_band(950e6, 1190e6, 3)
    np.testing.assert_allclose(channels.frequency, [990e6, 1070e6, 1150e6])
    np.testing.assert_allclose(channels.width, 80e6)
    assert len(channels) == 3


@pytest.mark.parametrize(
    ("low", "high", "count", "message"),
    [(2e9, 1e9, 1, "empty"), (0.0, 1e9, 1, "empty"), (1e9, 2e9, 0, "0 channels")],
)
def test_a_wrong_band_is_refused(low, high, count, message):
    with pytest.raises(InputError, match=message):
        Channels.from_band(low, high, count)


@pytest.mark.parametrize(("frequency", "width"), [(-1.0, 1.0), (1.0, 0.0), (np.nan, 1.0)])
def test_channels_are_positive(frequency, width):
    with pytest.raises(InputError, match="is not positive"):
        Channels(np.array([frequency]), np.array([width]))
