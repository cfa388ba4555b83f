"""The antennas of an MSv4 store: their names, positions and dishes, so far as they are known."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeAlias

import numpy as np

from uvshear.errors import InputError
from uvshear.io.msv4.opening import Dataset, open_group
from uvshear.io.msv4.variables import numbers, texts
from uvshear.typing import Array, Float, Int

SUBGROUP: Final = "antenna_xds"
"""Subgroup of a partition that describes its antennas."""

_Known: TypeAlias = tuple[Float[Array, " coordinate"], float]
"""Position and diameter of an antenna [m]."""


@dataclass(frozen=True)
class Antennas:
    """Antennas of a store; the number of an antenna is its index in the list of names.

    Parameters
    ----------
    names
        Names of the antennas.
    positions
        Geocentric positions [m]; NaN where they are not known.
    diameters
        Diameters of the dishes [m]; 0 where they are not known.
    telescope
        Name of the telescope; empty where it is not given.
    """

    names: tuple[str, ...]
    positions: Float[Array, "antenna 3"]
    diameters: Float[Array, " antenna"]
    telescope: str = ""

    def numbers_of(self, names: Sequence[str]) -> Int[Array, " baseline"]:
        """Return the numbers of antennas."""
        number = {name: place for place, name in enumerate(self.names)}
        return np.array([number[name] for name in names], int)


def baseline_names(place: Path, partition: Dataset) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of the first and of the second antenna of each baseline."""
    found = []
    for end in (1, 2):
        name = f"baseline_antenna{end}_name"
        if name not in partition.variables or partition[name].dims != ("baseline_id",):
            raise InputError(
                f"{place}: has no coordinate {name} with one name for each baseline_id; it is needed"
            )
        found.append(texts(place, partition, name))
    return found[0], found[1]


def read_antennas(places: Sequence[Path]) -> Antennas:
    """Read the antennas of some partitions, each antenna once.

    An antenna that a baseline names but ``antenna_xds`` does not describe has no position. Visibilities can be used
    without positions and diameters, but not if two antennas of a partition have the same name.
    """
    known: dict[str, _Known] = {}
    telescope = ""
    for place in places:
        with open_group(place) as partition:
            named = [
                *dict.fromkeys(name for end in baseline_names(place, partition) for name in end)
            ]
        described, name = _described(place / SUBGROUP)
        telescope = telescope or name
        for antenna, (position, diameter) in described.items():
            known.setdefault(antenna, (position, diameter))
        for antenna in named:
            known.setdefault(antenna, (np.full(3, np.nan), 0.0))
    return Antennas(
        tuple(known),
        np.array([position for position, _ in known.values()], float).reshape(-1, 3),
        np.array([diameter for _, diameter in known.values()], float),
        telescope,
    )


def _described(group: Path) -> tuple[dict[str, _Known], str]:
    """Return the position and the diameter of the antennas that a group describes, and the telescope."""
    if not group.is_dir():
        return {}, ""
    with open_group(group) as antennas:
        if "antenna_name" not in antennas.variables:
            return {}, ""
        names = texts(group, antennas, "antenna_name")
        for place, name in enumerate(names):
            if name in names[:place]:
                raise InputError(
                    f"{group}: two antennas are called '{name}'; the names must differ, as baselines refer to them"
                )
        positions = _or_unknown(group, antennas, "ANTENNA_POSITION", ("cartesian_pos_label",))
        diameters = _or_unknown(group, antennas, "ANTENNA_DISH_DIAMETER", ())
        telescope = str(antennas.attrs.get("overall_telescope_name", ""))
    if positions is None or positions.shape != (len(names), 3):
        positions = np.full((len(names), 3), np.nan)
    if diameters is None:
        diameters = np.zeros(len(names))
    diameters = np.where(np.isfinite(diameters), diameters, 0.0)
    found = zip(names, zip(positions, diameters.tolist(), strict=True), strict=True)
    return dict(found), telescope


def _or_unknown(
    group: Path, antennas: Dataset, name: str, others: tuple[str, ...]
) -> Float[Array, "..."] | None:
    try:
        return numbers(group, antennas, name, ("antenna_name", *others))
    except InputError:
        return None
