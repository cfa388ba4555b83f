r"""Attenuation of a point source's visibility by averaging and by the dishes: real factors, sample by sample.

A correlator averages over a channel and an integration, during which the phase of a source away from the phase centre
turns. With tau = (u l + v m + w (n-1))/nu its delay and dphi the change of its phase over the integration, the factors
are

.. math:: \frac{\sin(\pi \tau \Delta\nu)}{\pi \tau \Delta\nu}\quad\text{and}\quad \frac{\sin(d\phi/2)}{d\phi/2}

(the first is eq. 4 of Rivi & Miller 2018, which has a different factor 1/c and no w). A galaxy is small, so that the
factor at its centre applies to all of it.

A sample may also be an average over a cell of (u, v, w), in which the phase of a source varies little. With the second
moments C of the baselines for which it stands, and the form Q of fourth degree (``AveragedRows``), its factor is

.. math:: \exp[-(x^\mathrm{T} C\, x + Q(x))/2], \quad x = 2\pi\, (l, m, n-1).
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from uvshear.geometry.directions import n_minus_one
from uvshear.interferometer.averaged_rows import FOURTH, SECOND, permutations_of
from uvshear.interferometer.coverage import EARTH_ROTATION
from uvshear.interferometer.kernels import (
    multiply_by_gaussian,
    multiply_by_sinc,
    multiply_by_sinc_single,
)
from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Float

AT_A_TIME: Final = 2**15
"""Number of samples whose attenuation is worked out together for one source: what is prepared stays in the cache."""


class AttenuatedSamples(ABC):
    """Attenuation of the same samples for some sources after others."""

    @abstractmethod
    def multiply(
        self,
        factors: Float[Array, "source sample"],
        l: Float[Array, " source"],
        m: Float[Array, " source"],
    ) -> None:
        """Multiply each row of ``factors`` in place by the attenuation of a point source at these direction cosines.

        If ``factors`` are in single precision, an error of 3e-7 is allowed.
        """


class Attenuation(ABC):
    """A real factor that depends on the sample and on the direction."""

    @abstractmethod
    def factor(self, samples: Samples, l: float, m: float) -> Float[Array, " sample"]:
        """Factor of each sample for a point source at these direction cosines."""

    def over(self, samples: Samples) -> AttenuatedSamples:
        """Return the attenuation of these samples, for many sources; a subclass may override this to be faster."""
        return _OneByOne(self, samples)


@dataclass(frozen=True)
class _OneByOne(AttenuatedSamples):
    """The factor of every source computed from scratch."""

    attenuation: Attenuation
    samples: Samples

    def multiply(
        self,
        factors: Float[Array, "source sample"],
        l: Float[Array, " source"],
        m: Float[Array, " source"],
    ) -> None:
        for factor, *place in zip(factors, l.tolist(), m.tolist(), strict=True):
            factor[:] *= self.attenuation.factor(self.samples, *place)


class PreparedAttenuation(Attenuation):
    """An attenuation of which a part depends on the samples alone."""

    def factor(self, samples: Samples, l: float, m: float) -> Float[Array, " sample"]:
        """Factor of each sample for a point source at these direction cosines."""
        factors = np.ones((1, len(samples)))
        for start in range(0, len(samples), AT_A_TIME):
            some = slice(start, start + AT_A_TIME)
            prepared = self.over(samples.select(some))
            prepared.multiply(factors[:, some], np.array([l]), np.array([m]))
        return factors[0]

    @abstractmethod
    def over(self, samples: Samples) -> AttenuatedSamples:
        """Return the attenuation of these samples, for many sources."""


@dataclass(frozen=True)
class BandwidthSmearing(PreparedAttenuation):
    """Average over channels with a rectangular response."""

    def over(self, samples: Samples) -> AttenuatedSamples:
        """Return the attenuation of these samples, for many sources."""
        baselines = np.ascontiguousarray(samples.uvw.T, float)
        return _Averaged(baselines, samples.bandwidth / samples.frequency, np.eye(3))


@dataclass(frozen=True)
class TimeSmearing(PreparedAttenuation):
    """Average over integrations, while the Earth turns the baselines about the pole.

    Parameters
    ----------
    declination
        Declination of the phase centre [rad].
    """

    declination: float

    def over(self, samples: Samples) -> AttenuatedSamples:
        """Return the attenuation of these samples, for many sources."""
        baselines = np.ascontiguousarray(samples.uvw.T, float)
        rotation = rotation_matrix(self.declination)
        return _Averaged(baselines, samples.interval.astype(float), rotation)


@dataclass(frozen=True)
class _Averaged(AttenuatedSamples):
    """Average over a range of phases: sin(pi x)/(pi x) with x = scale (rotation . uvw) . (l, m, n - 1)."""

    uvw: Float[Array, "3 sample"]
    scale: Float[Array, " sample"]
    rotation: Float[Array, "3 3"]

    def multiply(
        self,
        factors: Float[Array, "source sample"],
        l: Float[Array, " source"],
        m: Float[Array, " source"],
    ) -> None:
        with np.errstate(invalid="ignore"):  # beyond the horizon
            directions = np.stack([l, m, n_minus_one(l, m)], axis=-1)
        # A matrix product could depend on the number of sources in its last bits.
        directions = np.sum(directions[:, :, None] * self.rotation, axis=1)
        kernel = multiply_by_sinc_single if factors.dtype == np.float32 else multiply_by_sinc
        kernel(self.uvw, directions, self.scale, factors)


@dataclass(frozen=True)
class CellSmearing(PreparedAttenuation):
    """Average over cells of (u, v, w), for samples that are such averages (``AveragedRows``)."""

    def over(self, samples: Samples) -> AttenuatedSamples:
        """Return the attenuation of these samples, for many sources."""
        return _Scattered(samples.scatter)


_PLACES: Final = tuple(np.array(places) for places in (SECOND, FOURTH))
"""Coordinates whose products the coefficients of each degree stand for."""

_ORDERS: Final = np.array([permutations_of(place) for place in (*SECOND, *FOURTH)], float)
"""Number of times that each product occurs."""


@dataclass(frozen=True)
class _Scattered(AttenuatedSamples):
    """Average over baselines with these moments [wavelengths^2, wavelengths^4]."""

    scatter: Float[Array, "sample moment"]

    def multiply(
        self,
        factors: Float[Array, "source sample"],
        l: Float[Array, " source"],
        m: Float[Array, " source"],
    ) -> None:
        if not self.scatter.shape[1]:
            return
        with np.errstate(invalid="ignore"):  # beyond the horizon
            directions = np.stack([l, m, n_minus_one(l, m)], axis=-1)
        turning = 2 * math.pi * directions
        form = np.concatenate([turning[:, places].prod(axis=-1) for places in _PLACES], axis=-1)
        multiply_by_gaussian(self.scatter, -form * _ORDERS / 2, factors)


@dataclass(frozen=True)
class CombinedAttenuation(PreparedAttenuation):
    """Product of several attenuations."""

    parts: tuple[Attenuation, ...]

    def over(self, samples: Samples) -> AttenuatedSamples:
        """Return the product for these samples, for many sources."""
        return _Product([part.over(samples) for part in self.parts])


@dataclass(frozen=True)
class _Product(AttenuatedSamples):
    parts: Sequence[AttenuatedSamples]

    def multiply(
        self,
        factors: Float[Array, "source sample"],
        l: Float[Array, " source"],
        m: Float[Array, " source"],
    ) -> None:
        for part in self.parts:
            part.multiply(factors, l, m)


def total_attenuation(
    declination: float, primary_beam: Attenuation | None = None, *, smears: bool = True
) -> Attenuation | None:
    """Smearing and primary beam together, at a declination of the phase centre [rad]; None if there is neither."""
    parts: tuple[Attenuation, ...] = ()
    if smears:
        parts = (BandwidthSmearing(), TimeSmearing(declination), CellSmearing())
    if primary_beam is not None:
        parts = (*parts, primary_beam)
    return CombinedAttenuation(parts) if parts else None


def rotation_matrix(declination: float) -> Float[Array, "3 3"]:
    """Matrix whose product with (u, v, w) is its rate of change [1/s]."""
    sine, cosine = math.sin(declination), math.cos(declination)
    turning = [[0.0, -sine, cosine], [sine, 0.0, 0.0], [-cosine, 0.0, 0.0]]
    return EARTH_ROTATION * np.array(turning)
