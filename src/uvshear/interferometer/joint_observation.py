"""Several observations of one phase centre, read as one."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Self

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre, separation
from uvshear.interferometer.origin import origin_of
from uvshear.interferometer.visibilities import Observation, Visibilities

SAME_DIRECTION = 1e-3 * ARCSEC
"""Phase centres that are closer than this are taken to be the same [rad]."""


@dataclass(frozen=True)
class JointObservation:
    """Observations of one phase centre, one after the other."""

    phase_centre: PhaseCentre
    parts: tuple[Observation, ...]

    @classmethod
    def from_parts(cls, parts: Sequence[Observation]) -> Self:
        """Join observations, after a check that they share their phase centre."""
        first = parts[0]
        for part in parts[1:]:
            distance = separation(first.phase_centre, part.phase_centre)
            if distance > SAME_DIRECTION:
                raise InputError(
                    f"{origin_of(part).name}: its phase centre is {distance / ARCSEC:.3g} arcsec from that of"
                    f" {origin_of(first).name}; observations that are measured together must share their phase centre"
                )
        return cls(first.phase_centre, tuple(parts))

    def chunks(self) -> Iterator[Visibilities]:
        """Read every part once."""
        for part in self.parts:
            yield from part.chunks()
