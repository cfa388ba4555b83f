r"""Attenuation of a point source's visibility by averaging and by the dishes: real factors, sample by sample.

A correlator averages over a channel and an integration, during which the phase of a source away from the phase centre
turns. With tau = (u l + v m + w (n-1))/nu its delay and dphi the change of its phase over the integration, the factors
are

.. math:: \frac{\sin(\pi \tau \Delta\nu)}{\pi \tau \Delta\nu}\quad\text{and}\quad \frac{\sin(d\phi/2)}{d\phi/2}

(the first is eq. 4 of Rivi & Miller 2018, which has a different factor 1/c and no w). A galaxy is small, so that the
factor at its centre applies to all of it.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import reduce

import numpy as np

from uvshear.geometry.directions import n_minus_one
from uvshear.interferometer.coverage import EARTH_ROTATION
from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Float


class Attenuation(ABC):
    """A real factor that depends on the sample and on the direction."""

    @abstractmethod
    def factor(self, samples: Samples, l: float, m: float) -> Float[Array, " sample"]:
        """Factor of each sample for a point source at these direction cosines."""


@dataclass(frozen=True)
class BandwidthSmearing(Attenuation):
    """Average over channels with a rectangular response."""

    def factor(self, samples: Samples, l: float, m: float) -> Float[Array, " sample"]:
        """Factor by the average over the channel."""
        return np.sinc(_turns(samples.uvw, l, m) * (samples.bandwidth / samples.frequency))


@dataclass(frozen=True)
class TimeSmearing(Attenuation):
    """Average over integrations, while the Earth turns the baselines about the pole.

    Parameters
    ----------
    declination
        Declination of the phase centre [rad].
    """

    declination: float

    def factor(self, samples: Samples, l: float, m: float) -> Float[Array, " sample"]:
        """Factor by the average over the integration."""
        rate = _turns(rotation(samples.uvw, self.declination), l, m)
        return np.sinc(rate * samples.interval)


@dataclass(frozen=True)
class CombinedAttenuation(Attenuation):
    """Product of several attenuations."""

    parts: tuple[Attenuation, ...]

    def factor(self, samples: Samples, l: float, m: float) -> Float[Array, " sample"]:
        """Product of the factors."""
        factors = (part.factor(samples, l, m) for part in self.parts)
        return reduce(np.multiply, factors, np.ones(len(samples)))


def total_attenuation(
    declination: float, primary_beam: Attenuation | None = None, *, smears: bool = True
) -> Attenuation | None:
    """Smearing and primary beam together, at a declination of the phase centre [rad]; None if there is neither."""
    parts: tuple[Attenuation, ...] = ()
    if smears:
        parts = (BandwidthSmearing(), TimeSmearing(declination))
    if primary_beam is not None:
        parts = (*parts, primary_beam)
    return CombinedAttenuation(parts) if parts else None


def rotation(uvw: Float[Array, "sample 3"], declination: float) -> Float[Array, "sample 3"]:
    """Rate of change of (u, v, w) [1/s], as the Earth turns them about the pole, (0, cos dec, sin dec)."""
    u, v, w = uvw.T
    sine, cosine = math.sin(declination), math.cos(declination)
    return EARTH_ROTATION * np.column_stack([cosine * w - sine * v, sine * u, -cosine * u])


def _turns(uvw: Float[Array, "sample 3"], l: float, m: float) -> Float[Array, " sample"]:
    """Phase of a point source, in turns."""
    n1 = float(n_minus_one(np.array([l]), np.array([m]))[0])
    return uvw @ np.array([l, m, n1])
