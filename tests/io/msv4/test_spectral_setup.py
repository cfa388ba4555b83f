"""Channels and correlations of a partition."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from uvshear.errors import InputError
from uvshear.io.msv4.spectral_setup import read_setup

PLACE = Path("store/group")


def partition(
    width=2e6, correlations=("XX", "XY", "YX", "YY"), frequency=(1e9, 1.1e9, 1.2e9), **more
):
    attrs = {"units": "Hz"} if width is None else {"units": "Hz", "channel_width": {"data": width}}
    return xr.Dataset(
        more,
        coords={
            "frequency": ("frequency", list(frequency), attrs),
            "polarization": list(correlations),
        },
    )


def test_channels_share_their_width_and_were_averaged_over_it():
    found = read_setup(PLACE, partition(), is_sampled=False)
    np.testing.assert_array_equal(found.channels.width, 2e6)
    np.testing.assert_array_equal(found.averaged, 2e6)
    assert found.is_averaged
    assert found.correlations == ("XX", "XY", "YX", "YY")
    assert found.hands == (0, 3)


def test_samples_of_a_simulation_were_not_averaged():
    found = read_setup(PLACE, partition(), is_sampled=True)
    np.testing.assert_array_equal(found.averaged, 0.0)
    assert not found.is_averaged


@pytest.mark.parametrize("width", [np.nan, None])
def test_widths_of_an_irregular_window_are_a_variable(width):
    """xarray-ms writes them so."""
    widths = np.array([1e6, -2e6, 3e6])
    found = read_setup(
        PLACE, partition(width, CHANNEL_WIDTH=("frequency", widths)), is_sampled=False
    )
    np.testing.assert_array_equal(found.channels.width, [1e6, 2e6, 3e6])


def test_widths_may_be_a_list():
    found = read_setup(PLACE, partition([1e6, 2e6, 3e6]), is_sampled=False)
    np.testing.assert_array_equal(found.channels.width, [1e6, 2e6, 3e6])


def test_effective_widths_are_those_of_averages():
    name, axes = "EFFECTIVE_CHANNEL_WIDTH", ("time", "baseline_id", "frequency", "polarization")
    values = np.zeros((2, 2, 3, 4))
    values[0, 1] = np.array([1e6, 2e6, 0.0])[:, None]
    values[0, 0, 0, 0] = np.nan
    values[1] = 5e6
    found = read_setup(PLACE, partition(**{name: (axes, values)}), is_sampled=True)
    np.testing.assert_array_equal(found.averaged, [1e6, 2e6, 0.0])
    flat = partition(**{name: ("frequency", np.array([3e6, 4e6, 5e6]))})
    np.testing.assert_array_equal(
        read_setup(PLACE, flat, is_sampled=False).averaged, [3e6, 4e6, 5e6]
    )
    wild = partition(**{name: ("frequency", np.full(3, 1e300))})
    np.testing.assert_array_equal(read_setup(PLACE, wild, is_sampled=False).averaged, 2e6)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"width": None}, "frequency has no attribute channel_width, and there is no variable"),
        ({"width": [1e6, 2e6]}, "there are 2 channel widths and 3 frequencies"),
        ({"width": 0.0}, "a channel's width is not positive"),
        ({"frequency": (1e9, -1e9)}, "a channel's frequency is not positive"),
        ({"correlations": ("PP", "QQ")}, "the correlations PP, QQ do not give Stokes I"),
    ],
)
def test_what_gives_no_channels_or_no_stokes_i_is_refused(changes, message):
    with pytest.raises(InputError, match=f"^store/group: {message}"):
        read_setup(PLACE, partition(**changes), is_sampled=False)


def test_another_unit_of_frequency_is_refused():
    found = partition()
    found["frequency"].attrs["units"] = ["GHz"]
    with pytest.raises(InputError, match="frequency is in GHz; Hz is needed"):
        read_setup(PLACE, found, is_sampled=False)
