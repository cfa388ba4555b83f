"""Several Measurement Sets of one pointing, read as one observation."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre, direction_cosines
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.io.measurement_set import MeasurementSet
from uvshear.io.measurement_set_header import casacore_errors, open_table, read_direction
from uvshear.typing import Array, Float

SAME_DIRECTION = 1e-3 * ARCSEC
"""Phase centres closer than this are one."""

SAME_POINTING = ARCSEC
"""Dishes that point closer than this point the same way."""


@dataclass(frozen=True)
class JointObservation:
    """Observations of one phase centre, one after the other."""

    phase_centre: PhaseCentre
    parts: tuple[Observation, ...]

    def chunks(self) -> Iterator[Visibilities]:
        """Read every part once."""
        for part in self.parts:
            yield from part.chunks()


@dataclass(frozen=True)
class Reading:
    """Which visibilities of a set are read, and how; as :class:`MeasurementSet` has it."""

    column: str = "DATA"
    field: int | str | None = None
    scans: tuple[int, ...] | None = None
    heeds_flags: bool = True
    conjugates: bool = False
    subtracted: str | None = None

    def open(self, path: Path) -> MeasurementSet:
        """Open a set."""
        return MeasurementSet(
            path,
            column=self.column,
            field=self.field,
            heeds_flags=self.heeds_flags,
            scans=self.scans,
            conjugates=self.conjugates,
            subtracted=self.subtracted,
        )


def open_observation(
    paths: Sequence[Path],
    reading: Reading | None = None,
    prepared: Callable[[Observation], Observation] | None = None,
) -> Observation:
    """Open one or more Measurement Sets of the same phase centre, each ``prepared`` for itself."""
    if not paths:
        raise InputError("no Measurement Set is given; one or more are needed")
    resolved = [path.resolve() for path in paths]
    for index, path in enumerate(resolved):
        if path in resolved[:index]:
            raise InputError(f"{paths[index]}: is given twice; its visibilities would count twice")
    reading = reading or Reading()
    sets = [reading.open(path) for path in paths]
    parts = tuple(one if prepared is None else prepared(one) for one in sets)
    first = parts[0].phase_centre
    for path, part in zip(paths[1:], parts[1:], strict=True):
        other = part.phase_centre
        turn = math.remainder(other.ra - first.ra, 2 * math.pi) * math.cos(first.dec)
        distance = math.hypot(turn, other.dec - first.dec)
        if distance > SAME_DIRECTION:
            raise InputError(
                f"{path}: its phase centre is {distance / ARCSEC:.3g} arcsec from {paths[0]}'s;"
                " what is measured together shares it"
            )
    return parts[0] if len(parts) == 1 else JointObservation(first, parts)


def pointing_of(paths: Sequence[Path], reading: Reading) -> tuple[float, float]:
    """Direction cosines of where the dishes pointed, FIELD's REFERENCE_DIR, about the phase centre of the first set.

    A set that was rephased has another PHASE_DIR than it was observed with.
    """
    found = []
    for path in paths:
        one = reading.open(path)
        axis = read_direction(path, one.header.field_id, "REFERENCE_DIR")
        l, m, n = direction_cosines(one.phase_centre, np.array([axis.ra]), np.array([axis.dec]))
        if n[0] <= 0:
            raise InputError(
                f"{path}: the dishes pointed (REFERENCE_DIR) more than 90 degrees from the phase centre;"
                " --primary-beam none is needed"
            )
        found.append((float(l[0]), float(m[0])))
    for path, other in zip(paths[1:], found[1:], strict=True):
        if math.dist(other, found[0]) > SAME_POINTING:
            raise InputError(
                f"{path}: its dishes pointed elsewhere than those of {paths[0]} (REFERENCE_DIR);"
                " a primary beam needs one pointing"
            )
    return found[0] if math.hypot(*found[0]) > SAME_POINTING else (0.0, 0.0)


def dish_diameters(paths: Sequence[Path]) -> Float[Array, " antenna"]:
    """DISH_DIAMETER of each antenna [m], the same in all sets; 0 where it is not given."""
    found = [_diameters(path) for path in paths]
    for path, other in zip(paths[1:], found[1:], strict=True):
        if not np.array_equal(other, found[0]):
            raise InputError(
                f"{path}: its dishes are not those of {paths[0]}; a primary beam needs the same"
            )
    return found[0]


def _diameters(path: Path) -> Float[Array, " antenna"]:
    with open_table(path, "ANTENNA") as table, casacore_errors(path, "ANTENNA"):
        return np.asarray(table.getcol("DISH_DIAMETER"), float)
