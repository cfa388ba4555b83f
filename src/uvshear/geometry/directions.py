"""Directions on the sky and their cosines about a phase centre."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PhaseCentre:
    """Direction of l = m = 0, ICRS [rad]."""

    ra: float
    dec: float
