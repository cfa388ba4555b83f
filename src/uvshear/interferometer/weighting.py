"""Weightings other than the natural one: what they make of the weights of an observation.

A weighting multiplies the natural weights w = 1/sigma^2 by factors T. The noise of a sum over visibilities is then no
longer the beam's: what a weighting costs is in ``extraction.weighting_loss``.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.baseline_map import RINGS, BaselineMap, rings_of
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.typing import Array, Float, Int

Factors = Callable[[Visibilities], Float[Array, "row chan"]]
"""T of every sample of a chunk."""


class Weighting(ABC):
    """A way of weighting baselines; :func:`weighted` applies one after the other."""

    @abstractmethod
    def factors_for(self, observation: "WeightedObservation") -> Factors:
        """Return the factors for an observation, which is read first if need be."""


@dataclass(frozen=True)
class WeightedObservation:
    """An observation whose natural weights are multiplied by factors, and by a number."""

    natural: Observation
    factors: tuple[Factors, ...] = ()
    scale: float = 1.0

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self.natural.phase_centre

    def chunks(self) -> Iterator[Visibilities]:
        """Read everything once."""
        for seen, factors in self.with_factors():
            weights = (seen.weights * (self.scale * factors)).astype(seen.weights.dtype)
            yield replace(seen, weights=weights)

    def with_factors(self) -> Iterator[tuple[Visibilities, Float[Array, "row chan"]]]:
        """Read everything once: with natural weights, and their factors beside them."""
        for seen in self.natural.chunks():
            product = np.ones(seen.weights.shape)
            for factors in self.factors:
                product *= factors(seen)
            yield seen, product


def weighted(observation: Observation, weightings: Sequence[Weighting]) -> WeightedObservation:
    """Apply weightings in their order; each sees what those before it have made of the weights."""
    seen = WeightedObservation(observation)
    for weighting in weightings:
        seen = replace(seen, factors=(*seen.factors, weighting.factors_for(seen)))
    return seen


@dataclass(frozen=True)
class GaussianTaper(Weighting):
    """A Gaussian over the uv plane, whose transform has this full width at half maximum [rad]."""

    fwhm: float

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Return them by the length of the baseline alone."""
        sigma = math.sqrt(2 * math.log(2)) / (math.pi * self.fwhm)

        def factors(seen: Visibilities) -> Float[Array, "row chan"]:
            return np.exp(-((seen.uv_distance / sigma) ** 2) / 2)

        return factors


@dataclass(frozen=True)
class TukeyTaper(Weighting):
    """Half a cosine from 0 to 1 at either end of a range of baselines, none beyond it [wavelengths].

    Parameters
    ----------
    shortest, longest
        Ends of the range.
    rise, fall
        Lengths of the cosines; 0 is a sharp edge.
    """

    shortest: float = 0.0
    longest: float = math.inf
    rise: float = 0.0
    fall: float = 0.0

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Return them by the length of the baseline alone."""

        def factors(seen: Visibilities) -> Float[Array, "row chan"]:
            length = seen.uv_distance
            return _edge(length - self.shortest, self.rise) * _edge(
                self.longest - length, self.fall
            )

        return factors


def _edge(inside: Float[Array, "..."], width: float) -> Float[Array, "..."]:
    if width == 0:
        return (inside >= 0).astype(float)
    return (1 - np.cos(math.pi * np.clip(inside / width, 0, 1))) / 2


NO_WEIGHT = "no visibility carries weight; a wider uv range, or another weighting, is needed"

MOST_CELLS = 2**28
"""Of a grid of densities: 2 GB."""


@dataclass(frozen=True)
class Briggs(Weighting):
    r"""Between natural and uniform weights, by the weight W that each cell of the uv plane holds.

    .. math:: T = \frac{1}{1 + W f^2},\quad f^2 = \frac{(5 \cdot 10^{-R})^2}{\sum W^2 / \sum w}

    Parameters
    ----------
    robustness
        R, from -2 (all but uniform) to 2 (all but natural).
    field
        Cells are 1/field wide: that of the image, for an imager [rad].

    References
    ----------
    Briggs 1995, PhD thesis, New Mexico Tech, chapter 3.
    """

    robustness: float
    field: float

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Read the observation for the density of its weights."""
        density = _Density.of(observation, self.field)
        cells = density.weight[density.weight > 0]
        f_squared = (5 * 10**-self.robustness) ** 2 / float(np.sum(cells**2) / np.sum(cells))

        def factors(seen: Visibilities) -> Float[Array, "row chan"]:
            return 1 / (1 + density.around(seen) * f_squared)

        return factors


@dataclass(frozen=True)
class Uniform(Weighting):
    """The same weight for every cell of the uv plane that holds any; cells as of :class:`Briggs`."""

    field: float

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Read the observation for the density of its weights."""
        density = _Density.of(observation, self.field)
        mean = float(density.weight[density.weight > 0].mean())

        def factors(seen: Visibilities) -> Float[Array, "row chan"]:
            around = density.around(seen)
            return np.divide(mean, around, out=np.zeros_like(around), where=around > 0)

        return factors


@dataclass(frozen=True)
class _Density:
    """Sums of weights on a grid over half of the uv plane, v >= 0."""

    field: float
    half: int
    weight: Float[Array, " cell"]

    @classmethod
    def of(cls, observation: Observation, field: float) -> "_Density":
        longest = 0.0
        for seen in observation.chunks():
            used = seen.uv_distance[seen.weights > 0]
            longest = max(longest, float(used.max(initial=0.0)))
        if longest == 0:
            raise InputError(NO_WEIGHT)
        half = math.ceil(longest * field) + 1
        cells = (2 * half + 1) * (half + 1)
        if cells > MOST_CELLS:
            raise InputError(
                f"--weight-field-arcmin {math.degrees(field) * 60:g}: a grid of {cells:.2g} cells for baselines of"
                f" {longest:.3g} wavelengths; a smaller field is needed"
            )
        density = cls(field, half, np.zeros(cells))
        for seen in observation.chunks():
            used = (seen.weights > 0).ravel()
            cell = density._cells(seen).ravel()[used]
            there, index = np.unique(cell, return_inverse=True)
            density.weight[there] += np.bincount(index, seen.weights.ravel()[used], len(there))
        return density

    def around(self, seen: Visibilities) -> Float[Array, "row chan"]:
        """Weight of the cell of each sample; 0 of samples without weight that are off the grid."""
        cell = self._cells(seen)
        return np.where(cell >= 0, self.weight[np.maximum(cell, 0)], 0.0)

    def _cells(self, seen: Visibilities) -> Int[Array, "row chan"]:
        scale = self.field * seen.frequency / SPEED_OF_LIGHT
        u, v = (seen.uvw[:, axis, None] * scale for axis in (0, 1))
        flipped = np.where((v < 0) | ((v == 0) & (u < 0)), -1, 1)
        u, v = (np.floor(part * flipped).astype(int) for part in (u, v))
        inside = (np.abs(u) <= self.half) & (v <= self.half)
        return np.where(inside, v * (2 * self.half + 1) + u + self.half, -1)


@dataclass(frozen=True)
class RoundPsf(Weighting):
    r"""Weights whose beam has no quadrupole, at whatever distance from its centre.

    A beam is as round as its weights: the quadrupole of any round weight over the beam is a sum over the lengths r of
    baselines of what the weights have there. On each ring of the uv plane the factors are those closest to 1 that have
    no quadrupole left:

    .. math::
        T = \max(0, 1 - \lambda_1 \cos 2\phi - \lambda_2 \sin 2\phi),\quad
        \sum w T e^{2 i \phi} = 0

    the minimum of :math:`\sum w (T - 1)^2` over T >= 0. A ring whose baselines point all in one half of the
    directions keeps no weight.
    """

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Read the observation for its weights over lengths and angles."""
        multipliers = _multipliers(BaselineMap.of((seen, None) for seen in observation.chunks()))

        def factors(seen: Visibilities) -> Float[Array, "row chan"]:
            whole, first, second = multipliers[:, rings_of(seen.uv_distance)]
            u, v = seen.uvw[:, 0, None], seen.uvw[:, 1, None]
            square = np.maximum(u * u + v * v, np.finfo(float).tiny)
            cosine, sine = (u * u - v * v) / square, 2 * u * v / square
            return np.maximum(0.0, whole - first * cosine - second * sine)

        return factors


MOST_STEPS = 100
_ROUND = 1e-10
_NOTHING = 1e-6
"""Part of a ring's weight that is taken for none."""


def _multipliers(cells: BaselineMap) -> Float[Array, "3 ring"]:
    """Return 1 and lambda of each ring; zeros of one that keeps nothing.

    Newton's method for all rings at once: the sums are piecewise linear in lambda, and convex.
    """
    angle = 2 * np.arctan2(cells.v, cells.u)
    waves = np.stack([np.cos(angle), np.sin(angle)])
    ring, weight = cells.ring, cells.weight

    def sums(values: Float[Array, " cell"]) -> Float[Array, " ring"]:
        return np.bincount(ring, values, RINGS)

    multipliers = np.zeros((2, RINGS))
    total = sums(weight)
    for _ in range(MOST_STEPS):
        factor = 1 - (multipliers[:, ring] * waves).sum(axis=0)
        kept = weight * (factor > 0)
        left = np.stack([sums(kept * factor * wave) for wave in waves])
        if np.all(np.abs(left) <= _ROUND * total):
            break
        # A ring of one direction has a singular matrix, one that keeps nothing an empty one.
        floor = np.where(total > 0, 1e-9 * total, 1.0)
        cc, cs, ss = (
            sums(kept * waves[i] * waves[j]) + (floor if i == j else 0)
            for i, j in ((0, 0), (0, 1), (1, 1))
        )
        determinant = cc * ss - cs**2
        step = np.stack([ss * left[0] - cs * left[1], cc * left[1] - cs * left[0]]) / determinant
        multipliers = multipliers + step
    kept = np.maximum(0.0, 1 - (multipliers[:, ring] * waves).sum(axis=0))
    keeps = sums(weight * kept) > _NOTHING * total
    return np.concatenate([np.ones((1, RINGS)), multipliers]) * keeps
