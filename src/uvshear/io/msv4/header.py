"""Metadata of an MSv4 store, with checks: everything but the visibilities."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.array_extent import ArrayExtent
from uvshear.interferometer.baseline_lengths import array_extent
from uvshear.io.msv4.antennas import Antennas, read_antennas
from uvshear.io.msv4.fields import FieldLabel, StoreField, choose_field
from uvshear.io.msv4.groups import attributes, correlated_groups
from uvshear.io.msv4.partition import Partition, filled_weights, probed, read_partition
from uvshear.io.msv4.sampled_baselines import sample_baselines


@dataclass(frozen=True)
class StoreHeader:
    """Metadata of a store that are read once.

    Parameters
    ----------
    field
        The field that is read.
    partitions
        Groups that have visibilities of this field.
    antennas
        Antennas of these partitions.
    weights
        Variable of weights, or of sigma, of each partition.
    extent
        The extent of the array by the positions of its antennas.
    """

    field: StoreField
    partitions: tuple[Partition, ...]
    antennas: Antennas
    weights: tuple[str, ...]
    extent: ArrayExtent

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self.field.phase_centre


def read_partitions(path: Path, column: str) -> tuple[Partition, ...]:
    """Read the descriptions of the groups of visibilities of a store."""
    if not path.exists():
        raise InputError(f"{path}: no such file; the path of an MSv4 store is needed")
    found = tuple(read_partition(group, column) for group in correlated_groups(path))
    if not any(len(partition.timeline) and partition.baselines[0] for partition in found):
        raise InputError(f"{path}: has no rows; an observation with visibilities is needed")
    return found


def fields_with_rows(partitions: Sequence[Partition]) -> dict[FieldLabel, list[Path]]:
    """Return the names of fields that have visibilities, in order of FIELD_ID, with the groups that describe them."""
    found: dict[FieldLabel, list[Path]] = {}
    for partition in partitions:
        creator = attributes(partition.group)
        for label in dict.fromkeys(partition.timeline.fields):
            place = FieldLabel.from_label(label, creator)
            found.setdefault(place, []).append(partition.fields_group)
    ordered = sorted(found, key=lambda label: -1 if label.number is None else label.number)
    return {label: found[label] for label in ordered}


def read_header(path: Path, column: str, field: int | str | None) -> StoreHeader:
    """Read the metadata and check them; an error is one line."""
    everything = read_partitions(path, column)
    chosen = choose_field(path, fields_with_rows(everything), field)
    names = chosen.names_in_store
    partitions = tuple(one for one in everything if one.timeline.chosen(names, None).any())
    antennas = read_antennas([partition.group for partition in partitions])
    weights = tuple(
        filled_weights(one, probed(np.flatnonzero(one.timeline.chosen(names, None))))
        for one in partitions
    )
    if not any(weights):
        raise InputError(
            f"{path}: no positive weights in {partitions[0].variables.weights}; it must hold 1/sigma^2"
        )
    uvw, integrations = sample_baselines(partitions, antennas, names)
    return StoreHeader(
        field=chosen,
        partitions=partitions,
        antennas=antennas,
        weights=tuple(
            name or one.variables.weights for name, one in zip(weights, partitions, strict=True)
        ),
        extent=array_extent(antennas.positions, antennas.diameters, integrations.antennas, uvw),
    )


def check_scans(path: Path, partitions: Sequence[Partition], scans: Sequence[int]) -> None:
    """Refuse scans that have no visibilities."""
    present = {name for partition in partitions for name in partition.timeline.scans}
    absent = [scan for scan in scans if str(scan) not in present]
    if absent:
        known = sorted(present, key=lambda name: (len(name), name))
        raise InputError(
            f"{path}: no rows of scan {absent[0]}; the scans with rows are {', '.join(known)}"
        )
