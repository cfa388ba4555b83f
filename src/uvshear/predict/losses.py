"""Losses of a source's visibilities by averaging and primary beams, for blocks of rows and channels."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Integrations
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class Losses:
    """An attenuation, with the properties of a block of visibilities that it needs.

    Parameters
    ----------
    attenuation
        Attenuation by averaging, by primary beams, or by both.
    width
        Widths of the channels [Hz]; None for visibilities that were not averaged.
    integrations
        Integrations of the rows; None where they are not known.
    """

    attenuation: Attenuation
    width: Float[Array, " chan"] | None = None
    integrations: Integrations | None = None

    @classmethod
    def from_attenuation(
        cls,
        attenuation: Attenuation | None,
        width: Float[Array, " chan"] | None,
        integrations: Integrations | None,
    ) -> Self | None:
        """Losses in a block of visibilities; None without an attenuation."""
        return None if attenuation is None else cls(attenuation, width, integrations)

    def samples(
        self,
        uvw: Float[Array, "row 3"],
        frequency: Float[Array, " chan"],
        rows: slice,
        chan: int,
    ) -> Samples:
        """Select some rows of one channel, without their data."""
        baselines = uvw[rows] * (frequency[chan] / SPEED_OF_LIGHT)
        count, taken = len(baselines), self.integrations
        width = 0.0 if self.width is None else self.width[chan]
        return Samples(
            uvw=baselines,
            stokes_i=np.zeros(count, np.complex64),
            weights=np.zeros(count, np.float32),
            frequency=np.full(count, frequency[chan], float),
            bandwidth=np.full(count, width, np.float32),
            interval=(
                np.zeros(count, np.float32)
                if taken is None
                else taken.interval[rows].astype(np.float32)
            ),
            antennas=(
                np.full((count, 2), -1, np.int16)
                if taken is None
                else taken.antennas[rows].astype(np.int16)
            ),
        )
