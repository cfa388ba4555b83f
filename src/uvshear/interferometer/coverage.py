"""Earth-rotation synthesis: the baselines of an array at each hour angle."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final, Self

import numpy as np

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.layout import ArrayLayout
from uvshear.typing import Array, Float, Int

EARTH_ROTATION: Final = 2 * math.pi * 1.00273790935 / 86400
"""Rate at which hour angles grow [rad/s of UT1], 0.27 % faster than 15 degrees per hour."""

J2000: Final = 51544.5 * 86400
"""2000 January 1, 12 h [MJD s]."""

SIDEREAL_TIME_AT_J2000: Final = math.radians(280.46061837)
"""Greenwich mean sidereal time at J2000 [rad] (Meeus, Astronomical Algorithms, eq. 12.4)."""


@dataclass(frozen=True)
class Track:
    """Times at which a direction is observed.

    Parameters
    ----------
    phase_centre
        Direction that the array follows.
    hour_angles
        Ranges (start, stop) of hour angle at the array's longitude [rad], in any order, without overlap. Each is
        filled with as many whole integrations as fit, but at least one, placed symmetrically about its middle.
    integration
        Length of a sample [s].
    elevation_limit
        Elevation below which samples are left out [rad]; None keeps all samples, even below the horizon.
    """

    phase_centre: PhaseCentre
    hour_angles: tuple[tuple[float, float], ...]
    integration: float
    elevation_limit: float | None = None

    def __post_init__(self) -> None:
        if not 0 < self.integration < math.inf:
            raise InputError(f"the integration is {self.integration:g} s; it must be positive")
        if not self.hour_angles:
            raise InputError("the track has no range of hour angles; at least one is needed")
        for start, stop in self.hour_angles:
            if not -math.inf < start < stop < math.inf:
                raise InputError(
                    f"the hour angles {_hours(start):g} h to {_hours(stop):g} h are not a range;"
                    " start < stop is needed"
                )
        if sum(stop - start for start, stop in self.hour_angles) > 2 * math.pi * (1 + 1e-9):
            raise InputError("the hour angles span more than 24 hours; 24 hours or less are needed")
        ordered = sorted(self.hour_angles)
        for (_, stop), (start, _) in pairwise(ordered):
            if start < stop:
                raise InputError(
                    f"two ranges of hour angles overlap at {_hours(start):g} h; join them"
                )

    @classmethod
    def from_clock(
        cls,
        phase_centre: PhaseCentre,
        ranges: tuple[tuple[float, float], ...],
        integration: float,
        elevation_limit: float | None = None,
    ) -> Self:
        """Take ranges in seconds of clock time from transit: a range of 8 h contains exactly 480 samples of 60 s."""
        hour_angles = tuple(
            (start * EARTH_ROTATION, stop * EARTH_ROTATION) for start, stop in ranges
        )
        return cls(phase_centre, hour_angles, integration, elevation_limit)

    @property
    def samples(self) -> Float[Array, " sample"]:
        """Hour angles of the samples' centres, increasing [rad]."""
        step = EARTH_ROTATION * self.integration
        return np.concatenate(
            [_sample_centres(start, stop, step) for start, stop in sorted(self.hour_angles)]
        )


@dataclass(frozen=True)
class Coverage:
    """All baselines at all times, in order of time.

    Parameters
    ----------
    layout
        The array.
    phase_centre
        Direction that w points to.
    antenna1, antenna2
        Indices into the layout, antenna1 < antenna2.
    time
        Centre of the sample, UTC [MJD s].
    integration
        Length of a sample [s].
    uvw
        X(antenna1) - X(antenna2): u to the East, v to the North, w to the phase centre [m].
    """

    layout: ArrayLayout
    phase_centre: PhaseCentre
    antenna1: Int[Array, " row"]
    antenna2: Int[Array, " row"]
    time: Float[Array, " row"]
    integration: float
    uvw: Float[Array, "row 3"]

    def __len__(self) -> int:
        return len(self.uvw)

    def rows(self, which: slice) -> Self:
        """Return a range of the rows, without copying them."""
        return replace(
            self,
            antenna1=self.antenna1[which],
            antenna2=self.antenna2[which],
            time=self.time[which],
            uvw=self.uvw[which],
        )


def synthesise(layout: ArrayLayout, track: Track) -> Coverage:
    r"""Compute the baselines of an array while the Earth turns below a direction.

    With the hour angle H at Greenwich (the local hour angle less the longitude) and the declination delta:

    .. math::

        u &= \sin H\,X + \cos H\,Y \\
        v &= -\sin\delta\cos H\,X + \sin\delta\sin H\,Y + \cos\delta\,Z \\
        w &= \cos\delta\cos H\,X - \cos\delta\sin H\,Y + \sin\delta\,Z

    Notes
    -----
    The phase centre's ICRS coordinates are used as the apparent coordinates. The samples are placed at the first
    transit after J2000, where this is correct to 5e-5 rad (nutation, aberration, UT1 - UTC).

    References
    ----------
    Thompson, Moran & Swenson 2017, Interferometry and Synthesis in Radio Astronomy, eq. 4.1.
    """
    hour_angle = _samples_above_limit(layout, track)
    uvw = antenna_uvw(layout.positions, hour_angle - layout.longitude, track.phase_centre.dec)
    first, second = np.triu_indices(len(layout), k=1)
    baselines = np.empty((len(uvw), len(first), 3))
    # One time at a time, which is in the processor's cache.
    for antennas, own in zip(uvw, baselines, strict=True):
        np.subtract(antennas[first], antennas[second], out=own)
    time = transit_time(layout.longitude, track.phase_centre.ra) + hour_angle / EARTH_ROTATION
    return Coverage(
        layout=layout,
        phase_centre=track.phase_centre,
        antenna1=np.tile(first.astype(np.int32), len(hour_angle)),
        antenna2=np.tile(second.astype(np.int32), len(hour_angle)),
        time=np.repeat(time, len(first)),
        integration=track.integration,
        uvw=baselines.reshape(-1, 3),
    )


def antenna_uvw(
    positions: Float[Array, "antenna 3"], greenwich_hour_angle: Float[Array, " sample"], dec: float
) -> Float[Array, "sample antenna 3"]:
    """Project positions on the axes East, North and towards the source, as in :func:`synthesise`."""
    sin_h, cos_h = np.sin(greenwich_hour_angle), np.cos(greenwich_hour_angle)
    sin_d, cos_d = math.sin(dec), math.cos(dec)
    zeros, ones = np.zeros_like(sin_h), np.ones_like(sin_h)
    axes = np.array(
        [
            [sin_h, cos_h, zeros],
            [-sin_d * cos_h, sin_d * sin_h, cos_d * ones],
            [cos_d * cos_h, -cos_d * sin_h, sin_d * ones],
        ]
    )
    return np.einsum("ijt,aj->tai", axes, positions)


def elevation(
    latitude: float, dec: float, hour_angle: Float[Array, " sample"]
) -> Float[Array, " sample"]:
    r"""Elevation above the horizon [rad].

    .. math:: \sin h = \sin\phi\sin\delta + \cos\phi\cos\delta\cos H
    """
    return np.arcsin(
        np.clip(
            math.sin(latitude) * math.sin(dec)
            + math.cos(latitude) * math.cos(dec) * np.cos(hour_angle),
            -1,
            1,
        )
    )


def sidereal_time(time: Float[Array, " sample"]) -> Float[Array, " sample"]:
    """Greenwich mean sidereal time [rad], not reduced to one turn, of UT1 [MJD s]."""
    return SIDEREAL_TIME_AT_J2000 + EARTH_ROTATION * (time - J2000)


def transit_time(longitude: float, ra: float) -> float:
    """First time after J2000 at which a right ascension culminates at a longitude [MJD s]."""
    angle = (ra - longitude - SIDEREAL_TIME_AT_J2000) % (2 * math.pi)
    return J2000 + angle / EARTH_ROTATION


def _hours(angle: float) -> float:
    return math.degrees(angle) / 15


def _sample_centres(start: float, stop: float, step: float) -> Float[Array, " sample"]:
    count = max(1, math.floor((stop - start) / step * (1 + 1e-9)))
    return (start + stop) / 2 + step * (np.arange(count) - (count - 1) / 2)


def _samples_above_limit(layout: ArrayLayout, track: Track) -> Float[Array, " sample"]:
    hour_angle = track.samples
    if track.elevation_limit is None:
        return hour_angle
    heights = elevation(layout.latitude, track.phase_centre.dec, hour_angle)
    above = heights >= track.elevation_limit
    if not above.any():
        culmination = math.pi / 2 - abs(layout.latitude - track.phase_centre.dec)
        limit = math.degrees(track.elevation_limit)
        advice = (
            "choose hour angles nearer to transit or a lower limit"
            if culmination > track.elevation_limit
            else "choose another declination or a lower limit"
        )
        raise InputError(
            f"a source at declination {math.degrees(track.phase_centre.dec):g} deg never rises above the elevation"
            f" limit of {limit:g} deg at {layout.name} within these hour angles (highest:"
            f" {math.degrees(heights.max()):.1f} deg; at transit: {math.degrees(culmination):.1f} deg); {advice}"
        )
    return hour_angle[above]
