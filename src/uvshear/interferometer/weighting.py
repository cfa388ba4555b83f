"""Weightings other than the natural one.

A weighting multiplies the natural weights w = 1/sigma^2 by factors T. The noise of a sum over visibilities then no
longer follows from the weights; ``diagnostics.weighting_loss`` computes the loss of information.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.execution import SERIAL, Executor
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.accumulate import Accumulator, accumulate
from uvshear.interferometer.baseline_map import (
    RINGS,
    BaselineMap,
    Factors,
    map_baselines,
    rings_of,
)
from uvshear.interferometer.origin import Origin, origin_of, parts_of
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.typing import Array, Float, Int


class Weighting(ABC):
    """A way of weighting baselines; :func:`weighted` applies several, one after the other."""

    @abstractmethod
    def factors_for(self, observation: "WeightedObservation") -> Factors:
        """Return the factors for an observation, which is read first if necessary."""


@dataclass(frozen=True)
class WeightedObservation:
    """An observation whose natural weights are multiplied by factors, and by a number.

    Parameters
    ----------
    natural
        The observation with natural weights.
    factors
        Functions whose results are multiplied with each other and with the natural weights.
    scale
        Number that all weights are multiplied by.
    """

    natural: Observation
    factors: tuple[Factors, ...] = ()
    scale: float = 1.0

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self.natural.phase_centre

    @property
    def parts(self) -> tuple["WeightedObservation", ...]:
        """Parts of the natural observation, each weighted."""
        inner = parts_of(self.natural)
        return tuple(replace(self, natural=part) for part in inner) if len(inner) > 1 else (self,)

    def origin(self) -> Origin:
        """Return the origin of the natural observation."""
        return replace(origin_of(self.natural), weights_tell_noise=False)

    def chunks(self) -> Iterator[Visibilities]:
        """Read everything once."""
        for seen in screened_chunks(self.natural):
            weights = (seen.weights * (self.scale * self.total_factors(seen))).astype(
                seen.weights.dtype
            )
            yield replace(seen, weights=weights, hand_powers=None)

    def total_factors(self, seen: Visibilities) -> Float[Array, "row chan"]:
        """Product of the factors for a chunk with natural weights, without ``scale``."""
        product = np.ones(seen.weights.shape)
        for factors in self.factors:
            product *= factors(seen)
        return product

    def map_baselines(self, executor: Executor = SERIAL) -> BaselineMap:
        """Read everything once for the natural weights and their factors, without ``scale``."""
        return map_baselines(self.natural, self.total_factors, executor)


def weighted(observation: Observation, weightings: Sequence[Weighting]) -> WeightedObservation:
    """Apply weightings in their order; each starts from the weights that the ones before it have produced."""
    result = WeightedObservation(observation)
    for weighting in weightings:
        result = replace(result, factors=(*result.factors, weighting.factors_for(result)))
    return result


@dataclass(frozen=True)
class GaussianTaper(Weighting):
    """A Gaussian taper of the uv plane; ``fwhm`` is the full width at half maximum of its Fourier transform [rad]."""

    fwhm: float

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Return factors that depend on the length of the baseline alone."""
        sigma = math.sqrt(2 * math.log(2)) / (math.pi * self.fwhm)

        def factors(seen: Visibilities) -> Float[Array, "row chan"]:
            return np.exp(-((seen.uv_distance / sigma) ** 2) / 2)

        return factors


@dataclass(frozen=True)
class TukeyTaper(Weighting):
    """A range of baselines with a half cosine from 0 to 1 at either end, and no weight beyond.

    Parameters
    ----------
    shortest, longest
        Ends of the range [wavelengths].
    rise, fall
        Lengths of the half cosines [wavelengths]; 0 is a sharp edge.
    """

    shortest: float = 0.0
    longest: float = math.inf
    rise: float = 0.0
    fall: float = 0.0

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Return factors that depend on the length of the baseline alone."""

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
"""Largest number of cells of a grid of densities: 2 GB."""


@dataclass(frozen=True)
class Briggs(Weighting):
    r"""Weights between natural and uniform, from the total weight W in each cell of the uv plane.

    .. math:: T = \frac{1}{1 + W f^2},\quad f^2 = \frac{(5 \cdot 10^{-R})^2}{\sum W^2 / \sum w}

    Parameters
    ----------
    robustness
        R, from -2 (nearly uniform) to 2 (nearly natural).
    field
        Width of the field of view [rad]: cells of the uv plane are 1/field wide, as in an imager.

    References
    ----------
    Briggs 1995, PhD thesis, New Mexico Tech, chapter 3.
    """

    robustness: float
    field: float

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Read the observation for the density of its weights."""
        density = _density(observation, self.field)
        cells = density.weight[density.weight > 0]
        f_squared = (5 * 10**-self.robustness) ** 2 / float(np.sum(cells**2) / np.sum(cells))

        def factors(seen: Visibilities) -> Float[Array, "row chan"]:
            return 1 / (1 + density.around(seen) * f_squared)

        return factors


@dataclass(frozen=True)
class Uniform(Weighting):
    """The same total weight for every occupied cell of the uv plane; the cells are those of :class:`Briggs`."""

    field: float

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Read the observation for the density of its weights."""
        density = _density(observation, self.field)
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

    def around(self, seen: Visibilities) -> Float[Array, "row chan"]:
        """Weight of the cell of each sample; 0 for samples without weight that are off the grid."""
        cell = self.cells(seen)
        return np.where(cell >= 0, self.weight[np.maximum(cell, 0)], 0.0)

    def cells(self, seen: Visibilities) -> Int[Array, "row chan"]:
        scale = self.field * seen.frequency / SPEED_OF_LIGHT
        u, v = (seen.uvw[:, axis, None] * scale for axis in (0, 1))
        flipped = np.where((v < 0) | ((v == 0) & (u < 0)), -1, 1)
        u, v = (np.floor(part * flipped).astype(int) for part in (u, v))
        inside = (np.abs(u) <= self.half) & (v <= self.half)
        return np.where(inside, v * (2 * self.half + 1) + u + self.half, -1)


class _LongestBaseline(Accumulator[float]):
    """Finds the length of the longest baseline with weight [wavelengths]."""

    def __init__(self) -> None:
        self._longest = 0.0

    def add(self, seen: Visibilities) -> None:
        used = seen.uv_distance[seen.weights > 0]
        self._longest = max(self._longest, float(used.max(initial=0.0)))

    def merge(self, later: Self) -> None:
        self._longest = max(self._longest, later._longest)

    def result(self) -> float:
        return self._longest


class _DensityAccumulator(Accumulator[_Density]):
    """Adds up the weights of every cell."""

    def __init__(self, empty: _Density) -> None:
        self._density = empty

    def add(self, seen: Visibilities) -> None:
        used = (seen.weights > 0).ravel()
        cell = self._density.cells(seen).ravel()[used]
        filled, index = np.unique(cell, return_inverse=True)
        self._density.weight[filled] += np.bincount(index, seen.weights.ravel()[used], len(filled))

    def merge(self, later: Self) -> None:
        self._density.weight[:] += later._density.weight

    def result(self) -> _Density:
        return self._density


def _density(observation: Observation, field: float) -> _Density:
    (longest,) = accumulate(observation, [_LongestBaseline()])
    if longest == 0:
        raise InputError(NO_WEIGHT)
    half = math.ceil(longest * field) + 1
    cells = (2 * half + 1) * (half + 1)
    if cells > MOST_CELLS:
        raise InputError(
            f"--weight-field-arcmin {math.degrees(field) * 60:g} (field=): needs a grid of {cells:.2g} cells for"
            f" baselines of {longest:.3g} wavelengths, which is too large; a smaller field is needed"
        )
    empty = _Density(field, half, np.zeros(cells))
    density: _Density
    (density,) = accumulate(observation, [_DensityAccumulator(empty)])
    return density


@dataclass(frozen=True)
class RoundPsf(Weighting):
    r"""Weights whose PSF has no quadrupole at any distance from its centre.

    The quadrupole of a PSF under any round window is a sum, over the lengths of the baselines, of the quadrupole of the
    weights at that length. On each ring of the uv plane the factors are the ones closest to 1 that remove the
    quadrupole:

    .. math::
        T = \max(0, 1 - \lambda_1 \cos 2\phi - \lambda_2 \sin 2\phi),\quad
        \sum w T e^{2 i \phi} = 0

    the minimum of :math:`\sum w (T - 1)^2` over T >= 0. A ring whose baselines all lie within 90 degrees of
    position angle gets no weight, because no factors of zero or more can remove its quadrupole.
    """

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Read the observation for its weights over lengths and angles."""
        multipliers = _multipliers(map_baselines(observation))

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
"""Fraction of a ring's weight that counts as zero."""


def _multipliers(cells: BaselineMap) -> Float[Array, "3 ring"]:
    """Return 1, lambda_1 and lambda_2 of each ring; zeros for a ring that keeps no weight.

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
        # The matrix is singular for a ring of one direction, and zero for a ring that keeps no weight.
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
