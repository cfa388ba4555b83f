"""Posterior of ellipticity and size, sampled on a lattice that finds its own extent."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.shapes.correlator import Correlator
from uvshear.shapes.interpolative import DecomposedCorrelator
from uvshear.shapes.maximum import BestFit, search_radius, shape_covariance
from uvshear.shapes.position import MarginalLikelihood, PositionQuadrature
from uvshear.shapes.posterior_modes import DEPTH, PosteriorModes
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Bool, Complex, Float, Int

FAINT = 20.0
"""Signal-to-noise ratio below which positions and shapes far from the best fit are searched as well. Otherwise the
posterior of one galaxy in 300, at a ratio of 10 to 20, would miss its second peak, and with it the true shape."""

_WIDEST, _SHARPEST = 0.3, 1e-6
"""Largest and smallest standard deviations of e and ln alpha that are used to choose the steps of a lattice."""

_NARROWEST = 0.65
"""Standard deviation of the posterior along an axis of the lattice, in steps, below which the step is halved."""

_CORE, _FURTHEST = 2.5, 5.0
"""Radius of the points that are evaluated at once, in standard deviations, and its maximum in steps."""

_ROOM, _MOST_ROOM = 64, 200
"""Number of steps along an axis for which a lattice has room: beyond its starting points, and from the best fit at
most."""

_GROWTH = 1.5
"""Factor by which the lattice is widened where the posterior is wider than expected."""

_MOST_ATTEMPTS = 10


@dataclass(frozen=True)
class LatticeSteps:
    """Steps of a lattice over ellipticity and size.

    Parameters
    ----------
    relative
        Step over the Fisher error. The error of the trapezoidal rule for a Gaussian is 2 exp(-2 pi^2/step^2).
    widest_e
        Largest step in e.
    most_points
        Largest number of points; a posterior as wide as expected takes about 300 with the usual steps.
    """

    relative: float = 1.25
    widest_e: float = math.inf
    most_points: int = 2000


USUAL = LatticeSteps()

_NEIGHBOURS = np.vstack([np.eye(3, dtype=int), -np.eye(3, dtype=int)])


@dataclass(frozen=True)
class PosteriorSamples:
    """Nodes of the quadrature over e and ln alpha, with their posterior probabilities.

    Parameters
    ----------
    ellipticity, log_scale_length
        Shapes of the nodes; the size is ln(scale length / rad).
    probability
        Posterior probability of each node; the sum is 1.
    given_shape
        Likelihood, flux and position, given the shape of each node.
    is_covered
        Whether the nodes reach the border of the posterior on all sides.
    point
        Integer coordinates of the nodes: these are ``origin + axes @ point`` in (e1, e2, ln alpha).
    origin
        Node whose integer coordinates are zero, the best fit.
    axes
        Steps of the lattice in columns; the last is along ln alpha.
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
    correlator: Correlator,
    prior: ShapePrior,
    best: BestFit,
    information_fraction: float = 1.0,
) -> PosteriorSamples:
    """Posterior over (e, ln alpha) with flux and position marginalised.

    Parameters
    ----------
    correlator
        Correlator of the facet, centred on the best fit.
    prior
        Prior of the source's shape.
    best
        Best fit, where the lattice starts.
    information_fraction
        Factor of the log likelihood: the fraction of the information that is used.
    """
    position, others = quadrature(correlator, correlator, prior, best)
    return sample_about(best, position, prior, others, information_fraction=information_fraction)


def quadrature(
    correlator: Correlator,
    sums: Correlator | DecomposedCorrelator,
    prior: ShapePrior,
    best: BestFit,
) -> tuple[PositionQuadrature, Float[Array, "start 3"] | None]:
    """Nodes over the position, and shapes besides the best fit to start from, (e1, e2, ln alpha) in rows.

    The nodes lie about the best fit of a bright galaxy, and over all likely positions of a faint one.

    Parameters
    ----------
    correlator
        Correlator of the facet, centred on the best fit.
    sums
        Correlator that the nodes are for: the same, or one on the cells of a decomposition.
    prior
        Prior of the source's shape.
    best
        Best fit.
    """
    if best.snr >= FAINT:
        return PositionQuadrature.from_best_fit(sums, best, search_radius(correlator, prior)), None
    modes = PosteriorModes.from_lattices(correlator, prior, best)
    others = _coordinates(modes.ellipticity, modes.log_scale_length)
    return PositionQuadrature.from_modes(sums, modes), others


def sample_about(
    best: BestFit,
    position: PositionQuadrature,
    prior: ShapePrior,
    others: Float[Array, "start 3"] | None = None,
    *,
    information_fraction: float = 1.0,
    steps: LatticeSteps = USUAL,
) -> PosteriorSamples:
    """Posterior on a lattice that grows from the best fit and from other shapes.

    The lattice follows the axes of the Fisher covariance and takes in every point within ``DEPTH`` of the highest.
    Where the Fisher matrix is a poor guide, the lattice starts again: with half the step along an axis if the posterior
    is narrower, and along the axes of the covariance found so far if ``most_points`` do not cover a posterior so wide.

    Parameters
    ----------
    best
        Best fit, which is the first point of the lattice.
    position
        Nodes over the position.
    prior
        Prior of the source's shape.
    others
        Further shapes to grow from, (e1, e2, ln alpha) in rows.
    information_fraction
        Factor of the log likelihood: the fraction of the information that is used.
    steps
        Steps of the lattice.
    """
    starts = _coordinates(np.array([best.ellipticity]), np.array([best.log_scale_length]))
    if others is not None:
        starts = np.vstack([starts, others])
    density = _PosteriorDensity(position, prior, information_fraction)
    found = shape_covariance(best)
    axes = _axes(found, steps)
    for _ in range(_MOST_ATTEMPTS):
        core = _core(_in_steps(axes, found))
        samples = _Lattice(density, starts, axes, core, steps.most_points).flood()
        found = _covariance(samples)
        if not samples.is_covered:
            axes = _axes(_GROWTH**2 * found, steps)
            continue
        narrow = np.diag(_in_steps(axes, found)) < _NARROWEST**2
        if not narrow.any():
            break
        axes = axes * np.where(narrow, 0.5, 1.0)
    return samples


def _axes(covariance: Float[Array, "3 3"], steps: LatticeSteps) -> Float[Array, "3 3"]:
    """Give the steps along the axes of e, on which the size follows its mean, and along ln alpha alone, in columns."""
    values, vectors = np.linalg.eigh(covariance[:2, :2])
    along_e = steps.relative * np.sqrt(np.clip(values, _SHARPEST**2, _WIDEST**2))
    slope = (vectors.T @ covariance[:2, 2]) / np.maximum(values, _SHARPEST**2)
    given_e = covariance[2, 2] - slope**2 @ values
    axes = np.zeros((3, 3))
    axes[:2, :2], axes[2, :2] = vectors, slope
    axes[:, :2] *= np.minimum(along_e, steps.widest_e)
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
    """Points of an ellipsoid of ``_CORE`` standard deviations, which are needed in any case and evaluated at once."""
    # The axes of the lattice follow those of the covariance: its diagonal is enough.
    length = np.clip(_CORE * np.sqrt(np.maximum(np.diag(covariance), 0)), 0.5, _FURTHEST)
    reach = length.astype(int)
    box = np.stack(np.meshgrid(*(np.arange(-r, r + 1) for r in reach), indexing="ij"), axis=-1)
    points = box.reshape(-1, 3)
    inside = np.sum((points / length) ** 2, axis=1) <= 1
    return np.vstack([points[inside], _NEIGHBOURS])


@dataclass(frozen=True)
class _PosteriorDensity:
    """Log density of the posterior at a shape, up to a constant."""

    position: PositionQuadrature
    prior: ShapePrior
    information_fraction: float

    def allows(self, e: Complex[Array, " point"]) -> Bool[Array, " point"]:
        return np.isfinite(self.prior.ellipticity.log_density(e))

    def evaluate(
        self, e: Complex[Array, " point"], size: Float[Array, " point"]
    ) -> tuple[Float[Array, " point"], MarginalLikelihood]:
        marginal = self.position.marginalise(e, size)
        deviation = (size - self.prior.log_scale_length) / self.prior.log_scale_length_sigma
        log_prior = self.prior.ellipticity.log_density(e) - 0.5 * deviation**2
        return self.information_fraction * marginal.log_likelihood + log_prior, marginal


class _Lattice:
    """One lattice over the disc of ellipticities and the sizes.

    The first of the starts is one of its points, and the core lies about this one.
    """

    def __init__(
        self,
        density: _PosteriorDensity,
        starts: Float[Array, "sample 3"],
        axes: Float[Array, "3 3"],
        core: Int[Array, "point 3"],
        most: int,
    ) -> None:
        self._density, self._axes, self._most = density, axes, most
        self._origin = starts[0]
        away = np.rint((starts - self._origin) @ np.linalg.inv(axes).T)
        self._first = np.vstack([away[np.all(np.abs(away) <= _MOST_ROOM, axis=1)], core]).astype(
            int
        )
        self._room = np.minimum(np.abs(self._first).max(axis=0) + _ROOM, _MOST_ROOM)
        # Zeros that are never written take no memory.
        self._seen = np.zeros(2 * self._room + 1, bool)
        self._count, self._is_full = 0, False

    def flood(self) -> PosteriorSamples:
        """Grow from the starts until the border is reached on all sides, or until there are too many points."""
        # The edge of the disc may cut off the best fit itself, so that its neighbours are starts too.
        frontier = self._new_points(self._first)
        found: list[tuple[Array, Array, Array, MarginalLikelihood]] = []
        points: list[Int[Array, "point 3"]] = []
        highest = -math.inf
        while len(frontier) and not self._is_full:
            e, size = self._shape(frontier)
            log_density, marginal = self._density.evaluate(e, size)
            found.append((e, size, log_density, marginal))
            points.append(frontier)
            highest = max(highest, float(log_density.max()))
            inner = frontier[log_density > highest - DEPTH]
            frontier = self._new_points((inner[:, None, :] + _NEIGHBOURS).reshape(-1, 3))
            self._is_full |= self._count > self._most
        # Where no shape has any likelihood, nothing is known of the extent of the posterior.
        is_covered = len(frontier) == 0 and not self._is_full and highest > -math.inf
        return self._collect(found, np.concatenate(points), is_covered=is_covered)

    def _new_points(self, points: Int[Array, "point 3"]) -> Int[Array, "new 3"]:
        """Points within the disc that have not been seen before; a point beyond the room of the lattice ends it."""
        inside = np.all(np.abs(points) <= self._room, axis=1)
        self._is_full |= not inside.all()
        places = points[inside] + self._room
        codes = np.unique(np.ravel_multi_index(tuple(places.T), self._seen.shape))
        codes = codes[~self._seen.flat[codes]]
        self._seen.flat[codes] = True
        new = np.stack(np.unravel_index(codes, self._seen.shape), axis=-1) - self._room
        e, _ = self._shape(new)
        new = new[self._density.allows(e)]
        self._count += len(new)
        return new

    def _shape(
        self, points: Int[Array, "point 3"]
    ) -> tuple[Complex[Array, " point"], Float[Array, " point"]]:
        first, second, size = (self._origin + points @ self._axes.T).T
        return first + 1j * second, size

    def _collect(
        self,
        found: list[tuple[Array, Array, Array, MarginalLikelihood]],
        points: Int[Array, "sample 3"],
        *,
        is_covered: bool,
    ) -> PosteriorSamples:
        e, sizes, log_density, marginals = zip(*found, strict=True)
        density = np.concatenate(log_density)
        highest = float(density.max())
        probability = np.exp(density - highest) if highest > -math.inf else np.ones(len(density))
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
