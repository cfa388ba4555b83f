"""An observation before it is made."""

from dataclasses import dataclass

from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import ArrayLayout
from uvshear.interferometer.spectral_window import Channels


@dataclass(frozen=True)
class ObservingPlan:
    """Which array follows which direction for how long, in which channels."""

    layout: ArrayLayout
    track: Track
    channels: Channels
