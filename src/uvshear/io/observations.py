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
        distance = _between(first, part.phase_centre)
        if distance > SAME_DIRECTION:
            raise InputError(
                f"{path}: its phase centre is {distance / ARCSEC:.3g} arcsec from {paths[0]}'s;"
                " what is measured together shares it"
            )
    return parts[0] if len(parts) == 1 else JointObservation(first, parts)


def pointing_of(paths: Sequence[Path], reading: Reading) -> tuple[float, float]:
    """Direction cosines of where the dishes pointed, about the phase centre of the first set.

    That is REFERENCE_DIR of FIELD, DELAY_DIR in a set without: one that was rephased has another PHASE_DIR. A set with
    neither is taken to be as it was observed.
    """
    found = []
    for path in paths:
        one = reading.open(path)
        axis = _axis(path, one)
        l, m, n = direction_cosines(one.phase_centre, np.array([axis.ra]), np.array([axis.dec]))
        if n[0] <= 0:
            raise InputError(
                f"{path}: the dishes pointed more than 90 degrees from the phase centre (FIELD);"
                " --primary-beam none is needed"
            )
        found.append((float(l[0]), float(m[0])))
    for path, other in zip(paths[1:], found[1:], strict=True):
        if math.dist(other, found[0]) > SAME_POINTING:
            raise InputError(
                f"{path}: its dishes pointed elsewhere than those of {paths[0]} (FIELD);"
                " a primary beam needs one pointing"
            )
    return found[0] if math.hypot(*found[0]) > SAME_POINTING else (0.0, 0.0)


def _axis(path: Path, one: MeasurementSet) -> PhaseCentre:
    field = one.header.field_id
    with open_table(path, "FIELD") as fields:
        there = [
            name
            for name in ("REFERENCE_DIR", "DELAY_DIR")
            if name in fields.colnames() and fields.iscelldefined(name, field)
        ]
    axes = [read_direction(path, field, name) for name in there] or [one.phase_centre]
    apart = max(_between(axes[0], axis) for axis in axes)
    if apart > SAME_POINTING:
        raise InputError(
            f"{path}: REFERENCE_DIR and DELAY_DIR of FIELD are {apart / ARCSEC:.3g} arcsec apart, so that nobody knows"
            " where the dishes pointed; --primary-beam none, or a set where they agree, is needed"
        )
    return axes[0]


def _between(one: PhaseCentre, other: PhaseCentre) -> float:
    """Small angle between two directions [rad]."""
    turn = math.remainder(other.ra - one.ra, 2 * math.pi) * math.cos(one.dec)
    return math.hypot(turn, other.dec - one.dec)


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
