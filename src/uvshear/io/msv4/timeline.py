"""The times of an MSv4 partition, with the field and the scan of each."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from uvshear.errors import InputError
from uvshear.io.msv4.opening import Dataset
from uvshear.io.msv4.variables import numbers, quantity, texts, unit_of
from uvshear.typing import Array, Bool, Float

DAY: Final = 86400.0
"""One day [s]."""

EPOCHS: Final = {"unix": 40587 * DAY, "mjd": 0.0, "cxcsec": 50814 * DAY, "gps": 44244 * DAY}
"""Modified Julian Date of the zero point of each time format [s]. Leap seconds are neglected, as no phase depends on
the time."""


@dataclass(frozen=True)
class Timeline:
    """Times of a partition.

    Parameters
    ----------
    time
        Middle of each integration, as Modified Julian Date [s].
    integration
        Nominal length of the integrations [s]; None where it is not given.
    fields
        Name of the field at each time, as the store has it.
    scans
        Name of the scan at each time; empty where the store has no scans.
    """

    time: Float[Array, " step"]
    integration: float | None
    fields: tuple[str, ...]
    scans: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.time)

    def chosen(self, fields: Sequence[str], scans: Sequence[int] | None) -> Bool[Array, " step"]:
        """Tell which times are of some fields and scans."""
        wanted = np.isin(np.array(self.fields, dtype=np.str_), list(fields))
        if scans is not None and len(wanted):
            wanted &= np.isin(np.array(self.scans, dtype=np.str_), [str(scan) for scan in scans])
        return wanted


def read_timeline(place: Path, partition: Dataset, fields: Sequence[str]) -> Timeline:
    """Read the times of a partition.

    Parameters
    ----------
    place
        Path of the partition.
    partition
        The partition.
    fields
        Names of the fields in its subgroup: where there is only one, its name need not be given at each time.
    """
    time = numbers(place, partition, "time", ("time",))
    attributes = partition["time"].attrs
    kind, unit = str(attributes.get("format", "unix")), unit_of(attributes) or "s"
    if kind not in EPOCHS or unit not in {"s", "d"}:
        raise InputError(
            f"{place}: time is in the format '{kind}' with the unit '{unit}'; one of"
            f" {', '.join(EPOCHS)} in s or d is needed"
        )
    found = quantity(attributes, "integration_time")
    integration = None if found is None or len(found) > 1 else float(found[0])
    return Timeline(
        EPOCHS[kind] + time * (DAY if unit == "d" else 1.0),
        integration,
        _field_names(place, partition, fields),
        _along_time(place, partition, "scan_name") or ("",) * len(time),
    )


def _field_names(place: Path, partition: Dataset, fields: Sequence[str]) -> tuple[str, ...]:
    if found := _along_time(place, partition, "field_name"):
        return found
    if len(fields) != 1:
        raise InputError(
            f"{place}: has no coordinate field_name with one name for each time, but {len(fields)} fields; it is needed"
        )
    return (fields[0],) * partition.sizes["time"]


def _along_time(place: Path, partition: Dataset, name: str) -> tuple[str, ...]:
    """Return a coordinate of text with one value for each time; empty if there is none."""
    if name not in partition.variables:
        return ()
    found = partition[name]
    if found.dims == ():
        return texts(place, partition, name) * partition.sizes["time"]
    return texts(place, partition, name) if found.dims == ("time",) else ()
