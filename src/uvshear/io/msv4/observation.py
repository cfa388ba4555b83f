"""Read Stokes I from an MSv4 store, a block of times at a time."""

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.baseline_sense import sense_agrees
from uvshear.interferometer.origin import Origin
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.visibilities import Visibilities
from uvshear.io.correlated_rows import usable_chunks
from uvshear.io.msv4.blocks import BlockChoice, read_blocks
from uvshear.io.msv4.data_groups import choose_data_group
from uvshear.io.msv4.fields import read_direction
from uvshear.io.msv4.header import StoreHeader, check_scans, read_header
from uvshear.io.msv4.missing_parts import missing_parts
from uvshear.io.msv4.opening import open_group
from uvshear.io.msv4.partition import WEIGHT_OF_SIGMA, Partition
from uvshear.io.msv4.sampled_baselines import sample_baselines
from uvshear.io.reading import Reading
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class Msv4Store:
    """One field of an MSv4 store as an observation of Stokes I.

    It holds nothing open, so that it can be pickled; a worker opens the store by its path.

    Parameters
    ----------
    path
        Path of the store, or of one of its groups of visibilities.
    column
        Variable of visibilities, or the data group that it belongs to, or the column of the Measurement Set from which
        it was converted: DATA is VISIBILITY, CORRECTED_DATA is VISIBILITY_CORRECTED.
    field
        Name of the field; needed only where there are several. The FIELD_ID that xradio adds to names can be left out,
        or stand alone.
    memory
        Size of a chunk's buffers, whatever the size of the store [bytes].
    heeds_flags
        Whether flagged visibilities are left out; False is meant for a first look at a store whose flags are wrong.
    scans
        Names of the scans to read, which must be numbers; all unless given.
    conjugates
        Whether UVW is taken with the opposite sign, for a store whose visibilities do not agree with the stored sign.
    subtracted
        Variable of a model that is subtracted from the visibilities, named as a column is.
    """

    path: str | Path
    column: str = "DATA"
    field: int | str | None = None
    memory: int = 2**25
    heeds_flags: bool = True
    scans: tuple[int, ...] | None = None
    conjugates: bool = False
    subtracted: str | None = None
    header: StoreHeader = dataclasses.field(init=False, repr=False)

    def __post_init__(self) -> None:
        header = read_header(Path(self.path), self.column, self.field)
        if self.scans is not None:
            check_scans(Path(self.path), header.partitions, self.scans)
        for partition in header.partitions if self.subtracted is not None else ():
            self._model_of(partition)
        object.__setattr__(self, "header", header)

    @classmethod
    def from_reading(cls, path: str | Path, reading: Reading) -> Self:
        """Open a store as a reading says."""
        return cls(
            path,
            column=reading.column,
            field=reading.field,
            heeds_flags=reading.heeds_flags,
            scans=reading.scans,
            conjugates=reading.conjugates,
            subtracted=reading.subtracted,
        )

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0, the field's FIELD_PHASE_CENTER_DIRECTION."""
        return self.header.phase_centre

    @property
    def spectral_windows(self) -> tuple[Channels, ...]:
        """Channels of each partition that has visibilities of the field."""
        return tuple(partition.setup.channels for partition in self.header.partitions)

    def expected_samples(self) -> float:
        """Return the number of samples of all partitions, with those of other fields and scans."""
        return sum(
            len(each.timeline) * len(each.baselines[0]) * len(each.setup.channels)
            for each in self.header.partitions
        )

    def chunks(self) -> Iterator[Visibilities]:
        """Read the cross-correlations once; a chunk has one spectral window.

        Raises
        ------
        InputError
            At the end, when nothing read had a positive weight.
        """
        return usable_chunks(Path(self.path), self.unchecked_chunks(), self.scans)

    def unchecked_chunks(self) -> Iterator[Visibilities]:
        """Read everything once, including chunks without a cross-correlation and stores without a usable sample."""
        antennas, fields = self.header.antennas, self.header.field.names_in_store
        for partition, weights in zip(self.header.partitions, self.header.weights, strict=True):
            choice = BlockChoice(
                steps=partition.timeline.chosen(fields, self.scans),
                antennas=np.column_stack([antennas.numbers_of(end) for end in partition.baselines]),
                weights=weights,
                subtracted=None if self.subtracted is None else self._model_of(partition),
                heeds_flags=self.heeds_flags,
                sign=-1.0 if self.conjugates else 1.0,
            )
            setup = partition.setup
            for rows in read_blocks(partition, choice, self.memory):
                seen = rows.combine(setup.channels.frequency, setup.averaged)
                yield replace(seen, array=self.header.extent)

    def origin(self) -> Origin:
        """Return the store itself, under its path."""
        return Origin(self, str(self.path))

    def notices(self) -> tuple[str, ...]:
        """Return the facts in the metadata that a user of this store should know."""
        found = []
        if WEIGHT_OF_SIGMA in self.header.weights:
            found.append(f"WEIGHT has no value above zero; the weights are 1/{WEIGHT_OF_SIGMA}^2")
        if len(names := self.header.field.names_in_store) > 1:
            found.append(
                f"fields {', '.join(names)} have one name, {self.header.field.name}, and one phase centre; they are"
                " read as one field"
            )
        for partition in self.header.partitions:
            name = partition.variables.visibilities
            missing, parts = missing_parts(partition.group, name)
            if missing:
                found.append(
                    f"{missing} of the {parts} zarr chunks of {partition.group.name}/{name} have no file, as in an"
                    " incomplete copy; visibilities in them are taken to be 0"
                )
        if (notice := self.header.extent.notice) is not None:
            found.append(notice)
        of_times = [partition.averaging_notice for partition in self.header.partitions]
        found += dict.fromkeys(text for text in of_times if text is not None)
        for partition in self.header.partitions:
            found += [f"{partition.group.name}: {fact}" for fact in partition.setup.oddities]
        return tuple(found)

    def uvw_agrees(self) -> bool | None:
        """Whether UVW, as it is read, is X(antenna 1) - X(antenna 2) by the positions; None if neither sign fits."""
        header = self.header
        stored, integrations = sample_baselines(
            header.partitions, header.antennas, header.field.names_in_store
        )
        agrees = sense_agrees(stored, integrations, header.antennas.positions, header.phase_centre)
        return None if agrees is None else agrees is not self.conjugates

    def dish_diameters(self) -> Float[Array, " antenna"]:
        """Return ANTENNA_DISH_DIAMETER of each antenna [m]; 0 where it is not given."""
        return self.header.antennas.diameters

    def pointing_direction(self) -> PhaseCentre:
        """Return where the dishes pointed: FIELD_REFERENCE_CENTER_DIRECTION, or the phase centre in a store without."""
        label = self.header.field.labels[0]
        for partition in self.header.partitions:
            if label.label in partition.timeline.fields:
                return read_direction(partition.fields_group, label, wants_pointing=True)
        return self.phase_centre

    def _model_of(self, partition: Partition) -> str:
        """Return the variable of the model in a partition, or say why it cannot be subtracted."""
        assert self.subtracted is not None
        with open_group(partition.group) as group:
            model = choose_data_group(partition.group, group, self.subtracted).visibilities
        if model == partition.variables.visibilities:
            raise InputError(
                f"{self.path}: {self.column} would be subtracted from itself; --subtract (subtracted=) names the"
                " variable of a model"
            )
        return model
