"""The posterior of ellipticity and size, sampled on a lattice that finds its own extent."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.shapes.correlator import Correlator
from uvshear.shapes.interpolative import CondensedCorrelator
from uvshear.shapes.maximum import BestFit, search_radius, shape_covariance
from uvshear.shapes.position import MarginalLikelihood, PositionQuadrature
from uvshear.shapes.posterior_modes import DEPTH, Likely
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Complex, Float, Int

FAINT = 20.0
"""Signal-to-noise ratio below which other positions and shapes than those about the best fit are looked for. Without,
one galaxy in 300 at an SNR of 10 to 20 has its posterior's second peak, and the truth, left out."""

_WIDEST = 0.3
_SHARPEST = 1e-6
_NARROWEST = 0.65
"""Standard deviation of the posterior along an axis of the lattice, in steps, below which the step is halved."""

_CORE, _FURTHEST = 2.5, 5.0
_ROOM, _MOST_ROOM = 64, 200
"""Steps along an axis that a lattice has room for: about where it starts, and from the best fit at most."""

_GROWTH = 1.5
_MOST_ATTEMPTS = 10


@dataclass(frozen=True)
class Steps:
    """How fine a lattice is to be.

    Parameters
    ----------
    relative
        Step over the Fisher error. The trapezoidal rule's error for a Gaussian is 2 exp(-2 pi^2/step^2).
    widest_e
        Widest step in e.
    most_points
        A posterior as wide as expected takes about 300 of the usual steps.
    """

    relative: float = 1.25
    widest_e: float = math.inf
    most_points: int = 2000


USUAL = Steps()

_NEIGHBOURS = np.vstack([np.eye(3, dtype=int), -np.eye(3, dtype=int)])


@dataclass(frozen=True)
class PosteriorSamples:
    """Nodes of the quadrature over e and ln alpha, with their posterior probability (of sum 1).

    ``is_covered`` tells whether they reach the border of the posterior all round. The nodes are ``origin + axes @
    point`` in (e1, e2, ln alpha); the last of the axes (columns) is along ln alpha.
    """

    ellipticity: Complex[Array, " sample"]
    log_scale_length: Float[Array, " sample"]
    probability: Float[Array, " sample"]
    given_shape: MarginalLikelihood
    is_covered: bool
    point: Int[Array, "sample 3"]
    origin: Float[Array, " 3"]
    axes: Float[Array, "3 3"]


def sample_posterior(
    correlator: Correlator, prior: ShapePrior, best: BestFit, share: float = 1.0
) -> PosteriorSamples:
    """Posterior over (e, ln alpha), flux and position marginalised, about the best fit and whatever else is likely.

    The log likelihood counts by ``share``: the part of its information that is the galaxy's own.
    """
    position, others = quadrature(correlator, correlator, prior, best)
    return sample_about(best, position, prior, others, share=share)


def quadrature(
    correlator: Correlator,
    sums: Correlator | CondensedCorrelator,
    prior: ShapePrior,
    best: BestFit,
) -> tuple[PositionQuadrature, Float[Array, "start 3"] | None]:
    """Nodes over the position for ``sums``, and shapes to start from besides the best fit: (e1, e2, ln alpha) in rows.

    About the best fit of a bright galaxy, over all that is likely of a faint one.
    """
    if best.snr >= FAINT:
        return PositionQuadrature.about(sums, best, search_radius(correlator, prior)), None
    likely = Likely.of(correlator, prior, best)
    others = _coordinates(likely.ellipticity, likely.log_scale_length)
    return PositionQuadrature.over(sums, likely), others


def sample_about(
    best: BestFit,
    position: PositionQuadrature,
    prior: ShapePrior,
    others: Float[Array, "start 3"] | None = None,
    *,
    share: float = 1.0,
    steps: Steps = USUAL,
) -> PosteriorSamples:
    """Posterior on a lattice that grows from the best fit, and from ``others``: (e1, e2, ln alpha) in rows.

    It follows the axes of the Fisher covariance and takes in every point within ``DEPTH`` of the highest. Where the
    Fisher matrix misleads it starts again: with half the step along an axis if the posterior is narrower, along the
    axes found so far if it is so much wider that ``most_points`` do not cover it.
    """
    starts = _coordinates(np.array([best.ellipticity]), np.array([best.log_scale_length]))
    if others is not None:
        starts = np.vstack([starts, others])
    found = shape_covariance(best)
    axes = _axes(found, steps)
    for _ in range(_MOST_ATTEMPTS):
        core = _core(_in_steps(axes, found))
        samples = _Lattice(position, prior, starts, axes, core, share, steps.most_points).flood()
        found = _covariance(samples)
        if not samples.is_covered:
            axes = _axes(_GROWTH**2 * found, steps)
            continue
        narrow = np.diag(_in_steps(axes, found)) < _NARROWEST**2
        if not narrow.any():
            break
        axes = axes * np.where(narrow, 0.5, 1.0)
    return samples


def _axes(covariance: Float[Array, "3 3"], steps: Steps) -> Float[Array, "3 3"]:
    """Give the steps along the axes of e, the size following, and along ln alpha alone, as columns."""
    values, vectors = np.linalg.eigh(covariance[:2, :2])
    of_e = steps.relative * np.sqrt(np.clip(values, _SHARPEST**2, _WIDEST**2))
    slope = (vectors.T @ covariance[:2, 2]) / np.maximum(values, _SHARPEST**2)
    given_e = covariance[2, 2] - slope**2 @ values
    axes = np.zeros((3, 3))
    axes[:2, :2], axes[2, :2] = vectors, slope
    axes[:, :2] *= np.minimum(of_e, steps.widest_e)
    axes[2, 2] = steps.relative * math.sqrt(min(max(given_e, _SHARPEST**2), _WIDEST**2))
    return axes


def _covariance(samples: PosteriorSamples) -> Float[Array, "3 3"]:
    away = _coordinates(samples.ellipticity, samples.log_scale_length)
    away = away - samples.probability @ away
    return (away * samples.probability[:, None]).T @ away


def _in_steps(axes: Float[Array, "3 3"], covariance: Float[Array, "3 3"]) -> Float[Array, "3 3"]:
    to_steps = np.linalg.inv(axes)
    return to_steps @ covariance @ to_steps.T


def _core(covariance: Float[Array, "3 3"]) -> Int[Array, "point 3"]:
    """Points that are surely wanted, an ellipsoid of ``_CORE`` standard deviations: at once, not layer by layer."""
    # The axes of the lattice follow those of the covariance: its diagonal is enough.
    length = np.clip(_CORE * np.sqrt(np.maximum(np.diag(covariance), 0)), 0.5, _FURTHEST)
    reach = length.astype(int)
    box = np.stack(np.meshgrid(*(np.arange(-r, r + 1) for r in reach), indexing="ij"), axis=-1)
    points = box.reshape(-1, 3)
    inside = np.sum((points / length) ** 2, axis=1) <= 1
    return np.vstack([points[inside], _NEIGHBOURS])


class _Lattice:
    """One lattice over the disc of ellipticities and the sizes."""

    def __init__(
        self,
        position: PositionQuadrature,
        prior: ShapePrior,
        starts: Float[Array, "sample 3"],
        axes: Float[Array, "3 3"],
        core: Int[Array, "point 3"],
        share: float,
        most: int,
    ) -> None:
        """Put the lattice so that the first of the starts is one of its points; the ``core`` is about it."""
        self._position, self._prior, self._axes = position, prior, axes
        self._origin = starts[0]
        self._share, self._most = share, most
        away = np.rint((starts - self._origin) @ np.linalg.inv(axes).T)
        self._first = np.vstack([away[np.all(np.abs(away) <= _MOST_ROOM, axis=1)], core]).astype(
            int
        )
        self._room = np.minimum(np.abs(self._first).max(axis=0) + _ROOM, _MOST_ROOM)
        # Zeros that nobody writes take no memory.
        self._seen = np.zeros(2 * self._room + 1, bool)
        self._count, self._is_full = 0, False

    def flood(self) -> PosteriorSamples:
        """Grow from the starts until the border lies all round, or until there are too many points."""
        # The edge of the disc may cut off the best fit itself: begin with what is about it too.
        frontier = self._new_points(self._first)
        found: list[tuple[Array, Array, Array, MarginalLikelihood]] = []
        points: list[Int[Array, "point 3"]] = []
        highest = -math.inf
        while len(frontier) and not self._is_full:
            e, size, log_density, marginal = self._evaluate(frontier)
            found.append((e, size, log_density, marginal))
            points.append(frontier)
            highest = max(highest, float(log_density.max()))
            inner = frontier[log_density > highest - DEPTH]
            frontier = self._new_points((inner[:, None, :] + _NEIGHBOURS).reshape(-1, 3))
            self._is_full |= self._count > self._most
        is_covered = len(frontier) == 0 and not self._is_full
        return self._collect(found, np.concatenate(points), is_covered=is_covered)

    def _new_points(self, points: Int[Array, "point 3"]) -> Int[Array, "new 3"]:
        """Those not seen before, within the disc; one beyond the room that there is ends it."""
        inside = np.all(np.abs(points) <= self._room, axis=1)
        self._is_full |= not inside.all()
        places = points[inside] + self._room
        codes = np.unique(np.ravel_multi_index(tuple(places.T), self._seen.shape))
        codes = codes[~self._seen.flat[codes]]
        self._seen.flat[codes] = True
        new = np.stack(np.unravel_index(codes, self._seen.shape), axis=-1) - self._room
        e, _ = self._shape(new)
        new = new[np.isfinite(self._prior.ellipticity.log_density(e))]
        self._count += len(new)
        return new

    def _shape(
        self, points: Int[Array, "point 3"]
    ) -> tuple[Complex[Array, " point"], Float[Array, " point"]]:
        first, second, size = (self._origin + points @ self._axes.T).T
        return first + 1j * second, size

    def _evaluate(
        self, points: Int[Array, "point 3"]
    ) -> tuple[Array, Array, Array, MarginalLikelihood]:
        e, size = self._shape(points)
        marginal = self._position.marginalise(e, size)
        deviation = (size - self._prior.log_scale_length) / self._prior.log_scale_length_sigma
        log_prior = self._prior.ellipticity.log_density(e) - 0.5 * deviation**2
        log_density = self._share * marginal.log_likelihood + log_prior
        return e, size, log_density, marginal

    def _collect(
        self,
        found: list[tuple[Array, Array, Array, MarginalLikelihood]],
        points: Int[Array, "sample 3"],
        *,
        is_covered: bool,
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
            point=points,
            origin=self._origin,
            axes=self._axes,
        )


def _coordinates(
    e: Complex[Array, " sample"], log_scale_length: Float[Array, " sample"]
) -> Float[Array, "sample 3"]:
    return np.stack([e.real, e.imag, log_scale_length], axis=-1)
