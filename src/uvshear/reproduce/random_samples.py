"""Samples that are drawn at random from a wide band and a long track, with the averages in channel and integration."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.geometry.directions import n_minus_one_at
from uvshear.imaging.phase import baselines_seen_from
from uvshear.interferometer.coverage import EARTH_ROTATION
from uvshear.interferometer.layout import ArrayLayout
from uvshear.reproduce.paper_pointing import BAND, PaperPointing
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class Resolution:
    """Width of a channel and length of an integration.

    Parameters
    ----------
    channel
        Width of a channel [Hz].
    integration
        Length of an integration [s].
    """

    channel: float
    integration: float


@dataclass(frozen=True)
class RandomSamples:
    """Samples at random baselines, integrations and channels of an observation.

    Parameters
    ----------
    uvw
        Baselines [m].
    drift
        Change of the baselines during an integration [m].
    frequency
        Centres of the channels [Hz].
    resolution
        Width of the channels and length of the integrations.
    """

    uvw: Float[Array, "sample 3"]
    drift: Float[Array, "sample 3"]
    frequency: Float[Array, " sample"]
    resolution: Resolution

    @classmethod
    def draw(
        cls,
        pointing: PaperPointing,
        resolution: Resolution,
        number: int,
        rng: np.random.Generator,
    ) -> Self:
        """Draw samples of an observation, whose integrations and channels have this resolution."""
        layout = pointing.plan.layout
        (start, stop) = pointing.times[0]
        slots = round((stop - start) / resolution.integration)
        channels = max(1, round((BAND[1] - BAND[0]) / resolution.channel))
        first, second = np.triu_indices(len(layout), k=1)
        pair = rng.integers(len(first), size=number)
        time = start + (rng.integers(slots, size=number) + 0.5) * resolution.integration
        width = (BAND[1] - BAND[0]) / channels
        frequency = BAND[0] + (rng.integers(channels, size=number) + 0.5) * width
        baseline = layout.positions[first[pair]] - layout.positions[second[pair]]
        angle = time * EARTH_ROTATION
        half = resolution.integration * EARTH_ROTATION / 2
        uvw, before, after = (
            _projected(layout, baseline, angle + change, pointing.declination)
            for change in (0.0, -half, half)
        )
        return cls(uvw, after - before, frequency, resolution)

    def uv_from(self, l: float, m: float) -> Float[Array, "sample 2"]:
        """Return the baselines in the plane that is tangent to the sky at a direction [wavelengths]."""
        seen = baselines_seen_from(self.uvw, l, m)
        return np.ascontiguousarray(seen[:, :2] * (self.frequency / SPEED_OF_LIGHT)[:, None])

    def kept(self, l: float, m: float) -> Float[Array, " sample"]:
        r"""Return the fraction of a point's visibility that the averages keep.

        .. math:: \mathrm{sinc}(\pi \tau \Delta\nu)\,\mathrm{sinc}(\Delta\phi/2)

        with the delay tau of the direction and the change of its phase during the integration; sinc x = sin(x)/x.
        """
        direction = np.array([l, m, n_minus_one_at(l, m)])
        delay = self.uvw @ direction / SPEED_OF_LIGHT
        turn = 2 * math.pi * self.frequency / SPEED_OF_LIGHT * (self.drift @ direction)
        # numpy's sinc contains a factor of pi.
        kept: Float[Array, " sample"] = np.sinc(delay * self.resolution.channel) * np.sinc(
            turn / (2 * math.pi)
        )
        return kept


def _projected(
    layout: ArrayLayout,
    baseline: Float[Array, "sample 3"],
    hour_angle: Float[Array, " sample"],
    dec: float,
) -> Float[Array, "sample 3"]:
    """Project baselines at one hour angle each, as :func:`uvshear.interferometer.coverage.synthesise` does."""
    x, y, z = baseline.T
    angle = hour_angle - layout.longitude
    sin_h, cos_h = np.sin(angle), np.cos(angle)
    sin_d, cos_d = math.sin(dec), math.cos(dec)
    radial, across = cos_h * x - sin_h * y, sin_h * x + cos_h * y
    return np.column_stack([across, -sin_d * radial + cos_d * z, cos_d * radial + sin_d * z])
