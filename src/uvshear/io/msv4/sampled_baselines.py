"""A sample of the baselines of an MSv4 store, for comparison with the positions of its antennas."""

from collections.abc import Sequence

import numpy as np

from uvshear.interferometer.baseline_lengths import ROWS_COMPARED
from uvshear.interferometer.visibilities import Integrations
from uvshear.io.msv4.antennas import Antennas
from uvshear.io.msv4.opening import open_group, zarr_errors
from uvshear.io.msv4.partition import Partition, probed
from uvshear.typing import Array, Float


def sample_baselines(
    partitions: Sequence[Partition], antennas: Antennas, fields: Sequence[str]
) -> tuple[Float[Array, "row 3"], Integrations]:
    """Return UVW [m], the antennas and the times of rows of some fields, spread over the partitions and their times."""
    stored, pairs, times = [np.zeros((0, 3))], [np.zeros((0, 2), int)], [np.zeros(0)]
    for partition in partitions:
        baselines = np.column_stack([antennas.numbers_of(end) for end in partition.baselines])
        with open_group(partition.group) as group, zarr_errors(partition.group, "UVW"):
            uvw = group[partition.variables.uvw]
            for step in probed(np.flatnonzero(partition.timeline.chosen(fields, None))):
                taken = uvw.isel(time=step)
                found = np.asarray(taken.values, float)
                found = found if taken.dims[-1] == "uvw_label" else found.T
                present = ~np.isnan(found).all(axis=1)
                stored.append(found[present])
                pairs.append(baselines[present])
                times.append(np.full(np.count_nonzero(present), partition.timeline.time[step]))
    rows = sum(map(len, times))
    chosen = np.unique(np.linspace(0, max(rows - 1, 0), ROWS_COMPARED).astype(int))[:rows]
    time = np.concatenate(times)[chosen]
    compared = Integrations(np.concatenate(pairs)[chosen], time, np.zeros(len(time)))
    return np.concatenate(stored)[chosen], compared
