"""The dishes of an observation, on which its primary beam depends: their diameters and the pointing direction."""

import math
from typing import Protocol, runtime_checkable

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre, direction_cosines
from uvshear.interferometer.origin import Origin, origin_of, parts_of
from uvshear.interferometer.visibilities import Observation
from uvshear.typing import Array, Float

SAME_POINTING = ARCSEC
"""Pointings that are closer than this are taken to be the same [rad]."""


@runtime_checkable
class HasDishes(Protocol):
    """An observation that knows its dishes."""

    def dish_diameters(self) -> Float[Array, " antenna"]:
        """Return the diameter of each antenna's dish [m]; 0 where it is not known."""
        ...

    def pointing_direction(self) -> PhaseCentre:
        """Return the direction in which the dishes pointed, which a later change of phase centre does not change."""
        ...


def dish_diameters(observation: Observation) -> Float[Array, " antenna"]:
    """Return the diameter of each antenna's dish [m], which is the same in all parts; 0 where it is not known."""
    origins = [origin_of(part) for part in parts_of(observation)]
    found = [_with_dishes(origin).dish_diameters() for origin in origins]
    for origin, diameters in zip(origins[1:], found[1:], strict=True):
        if not np.array_equal(diameters, found[0]):
            raise InputError(
                f"{origin.name}: its dishes differ from those of {origins[0].name};"
                " a primary beam needs the same dishes in all parts"
            )
    return found[0]


def pointing_of(observation: Observation) -> tuple[float, float]:
    """Direction cosines (l, m) of the pointing direction about the phase centre of the observation."""
    origins = [origin_of(part) for part in parts_of(observation)]
    found = [_pointing(origin) for origin in origins]
    for origin, pointing in zip(origins[1:], found[1:], strict=True):
        if math.dist(pointing, found[0]) > SAME_POINTING:
            raise InputError(
                f"{origin.name}: its dishes pointed in another direction than those of {origins[0].name};"
                " a primary beam needs the same pointing in all parts"
            )
    return found[0] if math.hypot(*found[0]) > SAME_POINTING else (0.0, 0.0)


def _pointing(origin: Origin) -> tuple[float, float]:
    axis = _with_dishes(origin).pointing_direction()
    centre = origin.observation.phase_centre
    l, m, n = direction_cosines(centre, np.array([axis.ra]), np.array([axis.dec]))
    if n[0] <= 0:
        raise InputError(
            f"{origin.name}: the dishes pointed more than 90 degrees from the phase centre;"
            " measure without a primary beam (--primary-beam none, primary_beam=None)"
        )
    return float(l[0]), float(m[0])


def _with_dishes(origin: Origin) -> HasDishes:
    if not isinstance(origin.observation, HasDishes):
        raise InputError(
            f"{origin.name}: its format does not give the diameters and the pointing of the dishes, which a primary"
            " beam needs; measure without one (--primary-beam none, primary_beam=None)"
        )
    return origin.observation
