"""A sample of the baselines of a store."""

import numpy as np

from tests.io.measurement_sets import PHASE_CENTRE
from uvshear.interferometer.baseline_lengths import array_extent
from uvshear.interferometer.baseline_sense import sense_agrees
from uvshear.io.msv4.antennas import read_antennas
from uvshear.io.msv4.partition import read_partition
from uvshear.io.msv4.sampled_baselines import sample_baselines


def sampled(path):
    antennas = read_antennas([path / "field_0"])
    partition = read_partition(path / "field_0", "DATA")
    return antennas, *sample_baselines([partition], antennas, ["simulated_0"])


def test_rows_are_spread_over_all_times(store):
    antennas, uvw, integrations = sampled(store)
    assert uvw.shape == (256, 3)
    assert integrations.time[-1] - integrations.time[0] == 59 * 60
    extent = array_extent(antennas.positions, antennas.diameters, integrations.antennas, uvw)
    assert extent.longest_baseline < 1500
    assert sense_agrees(uvw, integrations, antennas.positions, PHASE_CENTRE) is True


def test_padding_is_not_sampled(tree, write):
    tree["field_0"]["UVW"][:, 1:] = np.nan
    _, uvw, integrations = sampled(write())
    assert len(uvw) == 16
    assert np.isfinite(uvw).all()
    assert (integrations.antennas == [0, 1]).all()


def test_an_empty_partition_has_no_sample(tree, write):
    tree["field_0"]["UVW"][:] = np.nan
    _, uvw, integrations = sampled(write())
    assert uvw.shape == (0, 3)
    assert integrations.antennas.shape == (0, 2)
