"""The posterior of the ellipticity, sampled on a lattice that finds its own extent."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.fit.correlator import Correlator
from uvshear.fit.maximum import (
    BestFit,
    ellipticity_covariance,
    log_scale_length_given_shape,
    search_radius,
)
from uvshear.fit.position import MarginalLikelihood, PositionQuadrature
from uvshear.fit.prior import ShapePrior
from uvshear.typing import Array, Complex, Float, Int

STEP = 1.0
"""Lattice step over the Fisher error. The trapezoidal rule's error for a Gaussian is 2 exp(-2 pi^2/step^2)."""

DEPTH = 8.0
"""Points this far in log density below the highest are the border: 4 sigma."""

_SIZE_NODES, _SIZE_WEIGHTS = np.polynomial.hermite.hermgauss(5)
_WIDEST = 0.25
_SHARPEST = 1e-6
_NARROWEST = 0.9
"""Standard deviation of the posterior along an axis of the lattice, in steps, below which the step is halved."""

_GROWTH = 1.5
_MOST_ATTEMPTS = 10
MOST_POINTS = 500
"""A posterior as wide as expected takes about 80 points."""

_NEIGHBOURS = np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])


@dataclass(frozen=True)
class PosteriorSamples:
    """Nodes of the quadrature over e and ln alpha, with their posterior probability (of sum 1).

    ``is_covered`` tells whether they reach the border of the posterior all round.
    """

    ellipticity: Complex[Array, " sample"]
    log_scale_length: Float[Array, " sample"]
    probability: Float[Array, " sample"]
    given_shape: MarginalLikelihood
    is_covered: bool


def sample_posterior(correlator: Correlator, prior: ShapePrior, best: BestFit) -> PosteriorSamples:
    """Posterior over (e, ln alpha), flux and position marginalised, about the best fit.

    The lattice follows the axes of the Fisher covariance and grows from the best fit over every point within
    ``DEPTH`` of the highest. Where the Fisher matrix misleads it starts again: with half the step if the posterior
    is narrower, along the axes found so far if it is so much wider that ``MOST_POINTS`` do not cover it.
    """
    position = PositionQuadrature.about(correlator, best, search_radius(correlator, prior))
    axes = STEP * _principal_axes(ellipticity_covariance(best))
    for _ in range(_MOST_ATTEMPTS):
        lattice = _Lattice(position, prior, best, axes)
        samples = lattice.flood()
        found = _covariance(samples)
        if not samples.is_covered:
            axes = STEP * _principal_axes(_GROWTH**2 * found)
        elif np.all(np.diag(_in_steps(axes, found)) > _NARROWEST**2):
            break
        else:
            axes = axes / 2
    return samples


def _principal_axes(covariance: Float[Array, "2 2"]) -> Float[Array, "2 2"]:
    """Axes of one standard deviation, as columns."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.clip(values, _SHARPEST**2, _WIDEST**2))


def _covariance(samples: PosteriorSamples) -> Float[Array, "2 2"]:
    away = _pairs(samples.ellipticity)
    away = away - samples.probability @ away
    return (away * samples.probability[:, None]).T @ away


def _in_steps(axes: Float[Array, "2 2"], covariance: Float[Array, "2 2"]) -> Float[Array, "2 2"]:
    to_steps = np.linalg.inv(axes)
    return to_steps @ covariance @ to_steps.T


class _Lattice:
    """One lattice over the disc of ellipticities, each point with its nodes in ln alpha."""

    def __init__(
        self,
        position: PositionQuadrature,
        prior: ShapePrior,
        best: BestFit,
        axes: Float[Array, "2 2"],
    ) -> None:
        self._position, self._prior, self._best, self._axes = position, prior, best, axes
        self._slope, self._size_sigma = log_scale_length_given_shape(best)
        self._seen: set[tuple[int, int]] = set()

    def flood(self) -> PosteriorSamples:
        """Grow from the best fit until the border lies all round, or until there are too many points."""
        # The edge of the disc may cut off the best fit itself: begin with its neighbours too.
        frontier = self._new_points(np.vstack([np.zeros((1, 2), int), _NEIGHBOURS]))
        found: list[tuple[Array, Array, Array, MarginalLikelihood]] = []
        highest = -math.inf
        while len(frontier) and len(self._seen) < MOST_POINTS:
            e, sizes, log_density, marginal = self._evaluate(frontier)
            found.append((e, sizes, log_density, marginal))
            of_point = log_density.reshape(-1, len(_SIZE_NODES)).max(axis=1)
            highest = max(highest, float(of_point.max()))
            inner = frontier[of_point > highest - DEPTH]
            frontier = self._new_points((inner[:, None, :] + _NEIGHBOURS).reshape(-1, 2))
        return _collect(found, is_covered=len(frontier) == 0)

    def _new_points(self, points: Int[Array, "point 2"]) -> Int[Array, "new 2"]:
        new = [p for p in dict.fromkeys(map(tuple, points.tolist())) if p not in self._seen]
        self._seen.update(new)
        if not new:
            return np.empty((0, 2), int)
        kept = np.array(new)
        e = self._ellipticity(kept)
        return kept[np.isfinite(self._prior.ellipticity.log_density(e))]

    def _ellipticity(self, points: Int[Array, "point 2"]) -> Complex[Array, " point"]:
        away = points @ self._axes.T
        return self._best.ellipticity + away[:, 0] + 1j * away[:, 1]

    def _evaluate(
        self, points: Int[Array, "point 2"]
    ) -> tuple[Array, Array, Array, MarginalLikelihood]:
        e = self._ellipticity(points)
        centre = self._best.log_scale_length + _pairs(e - self._best.ellipticity) @ self._slope
        # Gauss-Hermite about where the size should be given e; five nodes bear a miss of 1.5 sigma.
        reach = math.sqrt(2) * self._size_sigma * _SIZE_NODES
        sizes = (centre[:, None] + reach).ravel()
        e = np.repeat(e, len(_SIZE_NODES))
        weight = np.tile(np.log(_SIZE_WEIGHTS) + _SIZE_NODES**2, len(points))
        marginal = self._position.marginalise(e, sizes)
        deviation = (sizes - self._prior.log_scale_length) / self._prior.log_scale_length_sigma
        log_density = (
            marginal.log_likelihood - 0.5 * deviation**2 + self._prior.ellipticity.log_density(e)
        )
        return e, sizes, log_density + weight, marginal


def _pairs(e: Complex[Array, " sample"]) -> Float[Array, "sample 2"]:
    return np.stack([e.real, e.imag], axis=-1)


def _collect(
    found: list[tuple[Array, Array, Array, MarginalLikelihood]], *, is_covered: bool
) -> PosteriorSamples:
    e, sizes, log_density, marginals = zip(*found, strict=True)
    density = np.concatenate(log_density)
    probability = np.exp(density - density.max())
    return PosteriorSamples(
        ellipticity=np.concatenate(e),
        log_scale_length=np.concatenate(sizes),
        probability=probability / probability.sum(),
        given_shape=MarginalLikelihood(
            *(
                np.concatenate([getattr(m, name) for m in marginals])
                for name in MarginalLikelihood.__dataclass_fields__
            )
        ),
        is_covered=is_covered,
    )
