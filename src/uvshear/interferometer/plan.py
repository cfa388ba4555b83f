"""An observation before it is made."""

from dataclasses import dataclass

from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import ArrayLayout
from uvshear.interferometer.spectral_window import Channels


@dataclass(frozen=True)
class ObservingPlan:
    """Which array follows which direction for how long, in which channels.

    Parameters
    ----------
    is_averaged
        Over channels and integrations, as a correlator does; else samples are of one frequency and moment, as the
        paper's.
    primary_beam
        Of the dishes (``interferometer.primary_beam``); none unless given.
    """

    layout: ArrayLayout
    track: Track
    channels: Channels
    is_averaged: bool = False
    primary_beam: Attenuation | None = None
