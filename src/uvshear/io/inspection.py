"""What is in a Measurement Set, for people to see before anything is measured."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.interferometer.noise_estimate import noise_over_weights
from uvshear.io.measurement_set import MeasurementSet, MeasurementSetSummary
from uvshear.io.measurement_set_header import (
    casacore_errors,
    check_is_measurement_set,
    fields_present,
    open_table,
    visibility_columns,
)
from uvshear.io.observations import Reading
from uvshear.io.uvw_sign import uvw_sign_agrees

CORRELATIONS = {1: "I", 5: "RR", 6: "RL", 7: "LR", 8: "LL", 9: "XX", 10: "XY", 11: "YX", 12: "YY"}
"""Names of CORR_TYPE codes (casacore, Stokes::StokesTypes)."""

Range = tuple[float, float]


@dataclass(frozen=True)
class Telescope:
    """Name and antennas; dishes' diameters [m]."""

    name: str
    antennas: int
    diameters: tuple[float, ...]


@dataclass(frozen=True)
class FieldContent:
    """Rows of one field.

    Parameters
    ----------
    data
        The field as an observation.
    name
        Of the field.
    counts
        Of rows and samples.
    time
        Start and end, UTC [MJD s].
    interval
        Shortest and longest integration [s].
    baseline
        Shortest and longest projected baseline with weight [m].
    uv_distance
        The same in wavelengths.
    noise_over_weights
        Standard deviation of the noise over what the weights say; None where nothing tells.
    uvw_agrees
        Whether UVW, as it is read, is X(ANTENNA1) - X(ANTENNA2) by the antennas' positions; None if neither sign fits.
    """

    data: MeasurementSet
    name: str
    counts: MeasurementSetSummary
    time: Range
    interval: Range
    baseline: Range
    uv_distance: Range
    noise_over_weights: float | None
    uvw_agrees: bool | None


@dataclass(frozen=True)
class Inspection:
    """A Measurement Set at a glance; ``columns`` are those with visibilities, ``correlations`` of each DATA_DESC_ID."""

    telescope: Telescope
    columns: tuple[str, ...]
    correlations: tuple[tuple[str, ...], ...]
    fields: tuple[FieldContent, ...]


def inspect(path: Path, reading: Reading | None = None) -> Inspection:
    """Read a set, all of its fields unless one is chosen."""
    reading = reading or Reading()
    check_is_measurement_set(path)
    with open_table(path) as main, casacore_errors(path, "FIELD_ID"):
        columns = visibility_columns(main)
        present = fields_present(path, main)
    chosen = present if reading.field is None else [reading.field]
    return Inspection(
        _telescope(path),
        columns,
        _correlations(path),
        tuple(_content(replace(reading, field=one).open(path), present) for one in chosen),
    )


def _content(data: MeasurementSet, names: Mapping[int, str | None]) -> FieldContent:
    counts = MeasurementSetSummary()
    ranges = {name: [math.inf, -math.inf] for name in ("time", "interval", "baseline", "uv")}

    def widen(name: str, values: np.ndarray) -> None:
        known = ranges[name]
        known[:] = min(known[0], float(values.min())), max(known[1], float(values.max()))

    for seen, counted in data.counted_chunks():
        counts += counted
        if not len(seen) or seen.integrations is None:
            continue
        taken = seen.integrations
        half = taken.interval / 2
        widen("time", np.stack([taken.time - half, taken.time + half]))
        widen("interval", taken.interval)
        if (used := seen.weights > 0).any():
            per_metre = seen.frequency / SPEED_OF_LIGHT
            widen("uv", seen.uv_distance[used])
            widen("baseline", (seen.uv_distance / per_metre)[used])
    time, interval, baseline, uv_distance = ((low, high) for low, high in ranges.values())
    return FieldContent(
        data,
        names[data.header.field_id] or "",
        counts,
        time,
        interval,
        baseline,
        uv_distance,
        noise_over_weights(data) if counts.usable else None,
        _agrees(data),
    )


def _agrees(data: MeasurementSet) -> bool | None:
    stored = uvw_sign_agrees(data.path, data.column, data.header.field_id)
    return stored if stored is None else stored is not data.conjugates


def _telescope(path: Path) -> Telescope:
    with open_table(path, "OBSERVATION") as table, casacore_errors(path, "OBSERVATION"):
        names = list(table.getcol("TELESCOPE_NAME")) if table.nrows() else []
    with open_table(path, "ANTENNA") as table, casacore_errors(path, "ANTENNA"):
        count = table.nrows()
        diameters = np.unique(table.getcol("DISH_DIAMETER")) if count else np.zeros(0)
    known = tuple(float(one) for one in diameters if one > 0)
    return Telescope(str(names[0]) if names else "", count, known)


def _correlations(path: Path) -> tuple[tuple[str, ...], ...]:
    with open_table(path, "DATA_DESCRIPTION") as table, casacore_errors(path, "DATA_DESCRIPTION"):
        identifiers = table.getcol("POLARIZATION_ID")
    with open_table(path, "POLARIZATION") as table, casacore_errors(path, "POLARIZATION"):
        types = [table.getcell("CORR_TYPE", int(one)) for one in identifiers]
    return tuple(tuple(CORRELATIONS.get(int(code), str(code)) for code in one) for one in types)
