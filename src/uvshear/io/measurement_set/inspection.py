"""The content of a Measurement Set, field by field."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from uvshear.errors import InputError
from uvshear.interferometer.stokes import CORRELATION_NAMES
from uvshear.io.inspection import FieldContent, Inspection, Telescope, Window, examine
from uvshear.io.measurement_set.antennas import KnownAntennas
from uvshear.io.measurement_set.descriptions import DataDescription
from uvshear.io.measurement_set.fields import NamedField
from uvshear.io.measurement_set.header import read_fields, visibility_columns
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.measurement_set.opening import casacore_errors, open_table
from uvshear.io.reading import Reading


def inspect_measurement_set(path: Path, reading: Reading) -> Inspection:
    """Read a set once, all of its fields unless one is chosen."""
    fields = list(observations_of(path, reading))
    with open_table(path) as main:
        columns = visibility_columns(main)
    described = {one.identifier: one for field in fields for one in field.header.descriptions}
    return Inspection(
        tuple(_content(field) for field in fields),
        _telescope(path, fields[0].header.antennas),
        columns,
        tuple(_window(described[identifier]) for identifier in sorted(described)),
    )


def observations_of(path: Path, reading: Reading) -> Iterator[MeasurementSet]:
    """Yield each field of a set as an observation, or the one that is chosen."""
    for one in _readings(read_fields(path), reading):
        yield MeasurementSet.from_reading(path, one)


def _readings(present: Sequence[NamedField], reading: Reading) -> Iterator[Reading]:
    """Yield a reading for each field, by its name where this stands for several rows of FIELD."""
    names = [field.name for field in present]
    for field in present:
        is_named = len(field.numbers) > 1 and names.count(field.name) == 1
        chosen = field.name if is_named else field.numbers[0]
        yield replace(reading, field=chosen if reading.field is None else reading.field)
        if reading.field is not None:
            return


def _window(description: DataDescription) -> Window:
    channels = description.channels
    words = tuple(CORRELATION_NAMES.get(code, str(code)) for code in description.types)
    return Window(channels.frequency, channels.width, description.averaged, words)


def _content(field: MeasurementSet) -> FieldContent:
    # A set in which all is flagged can be inspected as well.
    quality, ranges, noise = examine(field, field.unchecked_chunks())
    return FieldContent(
        phase_centre=field.phase_centre,
        quality=quality,
        ranges=ranges,
        number=field.header.field.numbers[0],
        name=field.header.field.name,
        weight_column=field.header.weight_column,
        noise=noise,
        uvw_agrees=field.uvw_agrees(),
        has_averages=field.header.has_averages,
    )


def _telescope(path: Path, antennas: KnownAntennas) -> Telescope:
    diameters = antennas.diameters
    known = tuple(float(diameter) for diameter in np.unique(diameters) if diameter > 0)
    return Telescope(_telescope_name(path), len(diameters), known)


def _telescope_name(path: Path) -> str:
    """Return the telescope's name; empty where it is not given, as it serves information only."""
    try:
        with open_table(path, "OBSERVATION") as table, casacore_errors(path, "OBSERVATION"):
            return str(table.getcell("TELESCOPE_NAME", 0)) if table.nrows() else ""
    except InputError:
        return ""
