"""Comparison of the baselines in a Measurement Set with its antennas' positions; nothing is changed."""

from pathlib import Path

import numpy as np

from uvshear.interferometer.baseline_lengths import ROWS_COMPARED
from uvshear.interferometer.baseline_sense import sense_agrees
from uvshear.interferometer.visibilities import Integrations
from uvshear.io.measurement_set.header import Header
from uvshear.io.measurement_set.opening import casacore_errors, open_table


def uvw_sign_agrees(path: Path, header: Header) -> bool | None:
    """Whether UVW as stored is X(ANTENNA1) - X(ANTENNA2); False for the opposite, None if neither fits."""
    with open_table(path) as main, casacore_errors(path, "UVW"):
        rows = np.unique(np.linspace(0, header.rows - 1, ROWS_COMPARED).astype(int))
        chosen = main.selectrows(rows)
        stored = np.asarray(chosen.getcol("UVW"), dtype=float)
        antennas = np.column_stack([chosen.getcol("ANTENNA1"), chosen.getcol("ANTENNA2")])
        time = np.asarray(chosen.getcol("TIME"), dtype=float)
        same_field = (
            np.ones(len(rows), dtype=bool)
            if header.is_only_field
            else np.isin(chosen.getcol("FIELD_ID"), header.field.numbers)
        )
    compared = Integrations(antennas, time, np.zeros(len(rows))).select(same_field)
    return sense_agrees(
        stored[same_field], compared, header.antennas.positions, header.phase_centre
    )
