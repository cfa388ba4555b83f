"""Plan of a simulated observation."""

from dataclasses import dataclass

from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import ArrayLayout
from uvshear.interferometer.spectral_window import Channels


@dataclass(frozen=True)
class ObservingPlan:
    """Array, direction, time and channels of an observation to simulate.

    Parameters
    ----------
    layout
        Antennas.
    track
        Phase centre and times.
    channels
        Frequencies.
    is_averaged
        Whether samples are averages over channels and integrations, as from a correlator; otherwise each sample is at
        one frequency and one time, as in Rivi & Miller 2018.
    primary_beam
        Primary beam of the dishes (``interferometer.primary_beam``); none unless given.
    """

    layout: ArrayLayout
    track: Track
    channels: Channels
    is_averaged: bool = False
    primary_beam: Attenuation | None = None
