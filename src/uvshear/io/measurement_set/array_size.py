"""Comparison of UVW with the distances between the antennas of a Measurement Set."""

import numpy as np
from casacore import tables

from uvshear.interferometer.array_extent import ArrayExtent
from uvshear.interferometer.baseline_lengths import ROWS_COMPARED, array_extent
from uvshear.io.measurement_set.antennas import KnownAntennas


def array_size(main: tables.table, known: KnownAntennas) -> ArrayExtent:
    """Compare UVW with the positions of the antennas, in some rows."""
    rows = np.unique(np.linspace(0, main.nrows() - 1, ROWS_COMPARED).astype(int))
    chosen = main.selectrows(rows)
    antennas = np.column_stack([chosen.getcol("ANTENNA1"), chosen.getcol("ANTENNA2")])
    return array_extent(
        known.positions, known.diameters, antennas, np.asarray(chosen.getcol("UVW"), float)
    )
