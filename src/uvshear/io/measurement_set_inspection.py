"""The content of a Measurement Set, field by field."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from uvshear.io.inspection import FieldContent, Inspection, Telescope, Window, examine
from uvshear.io.measurement_set import MeasurementSet
from uvshear.io.measurement_set_header import (
    casacore_errors,
    check_is_measurement_set,
    fields_present,
    open_table,
    visibility_columns,
)
from uvshear.io.reading import Reading

CORRELATIONS = {1: "I", 5: "RR", 6: "RL", 7: "LR", 8: "LL", 9: "XX", 10: "XY", 11: "YX", 12: "YY"}
"""Names of CORR_TYPE codes (casacore, Stokes::StokesTypes)."""


def inspect_measurement_set(path: Path, reading: Reading) -> Inspection:
    """Read a set once, all of its fields unless one is chosen."""
    check_is_measurement_set(path)
    with open_table(path) as main, casacore_errors(path, "FIELD_ID"):
        columns = visibility_columns(main)
        names = fields_present(path, main)
    chosen = names if reading.field is None else [reading.field]
    fields = [MeasurementSet.from_reading(path, replace(reading, field=field)) for field in chosen]
    windows = [
        Window(
            description.channels.frequency, description.channels.width, description.averaged, words
        )
        for description, words in zip(
            fields[0].header.descriptions, _correlations(path), strict=True
        )
    ]
    return Inspection(
        tuple(_content(field, names) for field in fields),
        _telescope(path),
        columns,
        tuple(windows),
    )


def _content(field: MeasurementSet, names: Mapping[int, str | None]) -> FieldContent:
    # A set in which all is flagged can be inspected as well.
    quality, ranges, noise = examine(field, field.unchecked_chunks())
    number = field.header.field_id
    return FieldContent(
        phase_centre=field.phase_centre,
        quality=quality,
        ranges=ranges,
        number=number,
        name=names[number] or "",
        weight_column=field.header.weight_column,
        noise=noise,
        uvw_agrees=field.uvw_agrees(),
    )


def _telescope(path: Path) -> Telescope:
    with open_table(path, "OBSERVATION") as table, casacore_errors(path, "OBSERVATION"):
        names = list(table.getcol("TELESCOPE_NAME")) if table.nrows() else []
    with open_table(path, "ANTENNA") as table, casacore_errors(path, "ANTENNA"):
        count = table.nrows()
        diameters = np.unique(table.getcol("DISH_DIAMETER")) if count else np.zeros(0)
    known = tuple(float(diameter) for diameter in diameters if diameter > 0)
    return Telescope(str(names[0]) if names else "", count, known)


def _correlations(path: Path) -> tuple[tuple[str, ...], ...]:
    with open_table(path, "DATA_DESCRIPTION") as table, casacore_errors(path, "DATA_DESCRIPTION"):
        identifiers = table.getcol("POLARIZATION_ID")
    with open_table(path, "POLARIZATION") as table, casacore_errors(path, "POLARIZATION"):
        types = [table.getcell("CORR_TYPE", int(identifier)) for identifier in identifiers]
    return tuple(tuple(CORRELATIONS.get(int(code), str(code)) for code in codes) for codes in types)
