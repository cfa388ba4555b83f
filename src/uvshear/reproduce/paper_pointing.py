"""The observations of the paper: SKA-Mid for eight hours, at one declination or at a distance from the zenith."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Self

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.geometry.directions import PhaseCentre
from uvshear.imaging import ImageGrid
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet

LAYOUT: Final = "ska-mid-aa4"

BAND: Final = (950e6, 1190e6)
"""Edges of the single channel [Hz] (Rivi & Miller 2018, section 3)."""

ABOUT_TRANSIT: Final = ((-4 * 3600.0, 4 * 3600.0),)
"""Eight hours about transit, in seconds of clock time from transit."""

FROM_TRANSIT: Final = ((0.0, 8 * 3600.0),)
"""Eight hours that begin at transit."""

UNTIL_TRANSIT: Final = ((-8 * 3600.0, 0.0),)
"""Eight hours that end at transit."""


@dataclass(frozen=True)
class PaperPointing:
    """An observation with SKA-Mid in one channel, without a limit of the elevation.

    Parameters
    ----------
    declination
        Declination of the phase centre [rad].
    integration
        Length of a sample [s]; the paper has 60.
    times
        Ranges of clock time from transit [s].
    """

    declination: float = math.radians(-30.0)
    integration: float = 60.0
    times: tuple[tuple[float, float], ...] = ABOUT_TRANSIT

    @classmethod
    def from_zenith(
        cls,
        distance: float,
        integration: float,
        times: tuple[tuple[float, float], ...] = ABOUT_TRANSIT,
    ) -> Self:
        """Return the observation whose transit is at this distance North of the zenith [rad]."""
        return cls(load_layout(LAYOUT).latitude + distance, integration, times)

    @property
    def plan(self) -> ObservingPlan:
        """Array, track and channel."""
        centre = PhaseCentre(0.0, self.declination)
        track = Track.from_clock(centre, self.times, self.integration)
        return ObservingPlan(load_layout(LAYOUT), track, Channels.from_band(*BAND, 1))

    def unit_visibilities(self) -> VisibilitySet:
        """Return the samples with visibilities and weights of 1."""
        return _unit_visibilities(self)


BASELINE: Final = PaperPointing()
"""The observation of most experiments, at declination -30 deg."""

PSF_GRID: Final = ImageGrid(600, 0.1 * ARCSEC)
"""Pixels of images of the PSF: a minute of arc."""


@lru_cache(maxsize=1)
def _unit_visibilities(pointing: PaperPointing) -> VisibilitySet:
    plan = pointing.plan
    uvw = synthesise(plan.layout, plan.track).uvw
    shape = (len(uvw), 1)
    block = Visibilities(
        uvw, plan.channels.frequency, np.ones(shape, np.complex64), np.ones(shape, np.float32)
    )
    return VisibilitySet(plan.track.phase_centre, (block,))
