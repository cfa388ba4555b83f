"""The content of an MSv4 store, field by field."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from uvshear.io.inspection import FieldContent, Inspection, Telescope, Window, examine
from uvshear.io.msv4.antennas import read_antennas
from uvshear.io.msv4.data_groups import visibility_variables
from uvshear.io.msv4.fields import StoreField, grouped
from uvshear.io.msv4.header import fields_with_rows, read_partitions
from uvshear.io.msv4.observation import Msv4Store
from uvshear.io.msv4.opening import open_group
from uvshear.io.msv4.partition import Partition
from uvshear.io.reading import Reading


def inspect_store(path: Path, reading: Reading) -> Inspection:
    """Read a store once, all of its fields unless one is chosen."""
    partitions = read_partitions(path, reading.column)
    if reading.field is None:
        present = grouped(path, fields_with_rows(partitions))
        fields = [Msv4Store.from_reading(path, one) for one in _readings(present, reading)]
    else:
        fields = [Msv4Store.from_reading(path, reading)]
    described = {one.group: one for field in fields for one in field.header.partitions}
    return Inspection(
        tuple(_content(field) for field in fields),
        _telescope(partitions),
        _variables(partitions),
        tuple(_window(one) for one in partitions if one.group in described),
    )


def _readings(present: tuple[StoreField, ...], reading: Reading) -> Iterator[Reading]:
    """Yield a reading for each field, which is chosen by its name if it has several names in the store."""
    names = [field.name for field in present]
    for field in present:
        is_named = len(field.labels) > 1 and names.count(field.name) == 1
        yield replace(reading, field=field.name if is_named else field.names_in_store[0])


def _variables(partitions: tuple[Partition, ...]) -> tuple[str, ...]:
    found: dict[str, None] = {}
    for partition in partitions:
        with open_group(partition.group) as group:
            found |= dict.fromkeys(visibility_variables(group))
    return tuple(found)


def _window(partition: Partition) -> Window:
    setup = partition.setup
    channels = setup.channels
    return Window(channels.frequency, channels.width, setup.averaged, setup.correlations)


def _content(field: Msv4Store) -> FieldContent:
    # A store in which all is flagged can be inspected as well.
    quality, ranges, noise = examine(field, field.unchecked_chunks())
    return FieldContent(
        phase_centre=field.phase_centre,
        quality=quality,
        ranges=ranges,
        number=field.header.field.number,
        name=field.header.field.name,
        weight_column=field.header.weights[0],
        noise=noise,
        uvw_agrees=field.uvw_agrees(),
    )


def _telescope(partitions: tuple[Partition, ...]) -> Telescope:
    antennas = read_antennas([partition.group for partition in partitions])
    known = tuple(float(diameter) for diameter in np.unique(antennas.diameters) if diameter > 0)
    return Telescope(antennas.telescope, len(antennas.names), known)
