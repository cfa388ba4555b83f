"""The maximum of the likelihood of one galaxy: a robust starting point, and damped Gauss-Newton steps from there."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.numerics.damped_newton import Ascent, Ending, Schedule, climb
from uvshear.numerics.symmetric import with_eigenvalue_floor
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.lattices import hexagonal_lattice, shape_lattice
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Float

LARGEST_ELLIPTICITY = 0.95
"""Largest modulus of e that a fit may reach, where the prior allows it."""

_SCHEDULE = Schedule(tolerance=1e-3, most_steps=80, first=1e-3, least=1e-3, most=1e6, short=1.0)


@dataclass(frozen=True)
class BestFit:
    """Most likely parameters of a galaxy, with a prior on its size, in the correlator's units.

    Parameters
    ----------
    flux
        Flux of the galaxy.
    position
        Position of the galaxy from the centre of the facet.
    ellipticity
        e1 + i e2.
    log_scale_length
        ln(scale length / rad).
    information
        Fisher matrix of (flux, e1, e2, ln alpha), the priors included.
    position_information
        Fisher matrix of the position; position and shape decouple.
    has_converged
        Whether the maximum was reached.
    """

    flux: float
    position: Float[Array, " 2"]
    ellipticity: complex
    log_scale_length: float
    information: Float[Array, "4 4"]
    position_information: Float[Array, "2 2"]
    has_converged: bool

    @property
    def snr(self) -> float:
        """Signal-to-noise ratio S sqrt<m, m>; <m, m> is the first element of the Fisher matrix."""
        return self.flux * math.sqrt(float(self.information[0, 0]))


def maximise_likelihood(
    correlator: Correlator, prior: ShapePrior, start: GalaxyFit | None = None
) -> BestFit | None:
    """Find the most likely galaxy, and leave the correlator centred on it; None where no positive flux fits.

    The cross-correlation has many peaks. Without a ``start``, the climb begins at its highest peak within the prior on
    the position, with the best of a coarse lattice of shapes.
    """
    if start is None:
        correlator.move_to(_highest_peak(correlator, prior))
        guess = _best_of_lattice(correlator, prior)
        if guess is None:
            return None
        ellipticity, log_scale_length = guess
    else:
        correlator.move_to(start.offset / correlator.length)
        ellipticity, log_scale_length = start.ellipticity, math.log(start.scale_length)
    return _climb(correlator, prior, ellipticity, log_scale_length)


def search_radius(correlator: Correlator, prior: ShapePrior) -> float:
    """Radius of the prior on the position in the correlator's units."""
    if prior.position_radius is not None:
        return prior.position_radius / correlator.length
    return correlator.peak_width(prior.log_scale_length)


def shape_covariance(best: BestFit) -> Float[Array, "3 3"]:
    """Covariance of (e1, e2, ln alpha) from the Fisher matrix, the flux marginalised."""
    return np.linalg.inv(best.information)[1:, 1:]


def _highest_peak(correlator: Correlator, prior: ShapePrior) -> Float[Array, " 2"]:
    """Position of the highest cross-correlation with a round median galaxy on a lattice over the prior."""
    spacing = 0.7 * correlator.peak_width(prior.log_scale_length)
    nodes = hexagonal_lattice(search_radius(correlator, prior), spacing)
    displaced = correlator.displaced_to(nodes)
    heights, _ = correlator.correlate(np.array([0j]), np.array([prior.log_scale_length]), displaced)
    return nodes[np.argmax(heights[0])]


def _best_of_lattice(correlator: Correlator, prior: ShapePrior) -> tuple[complex, float] | None:
    """Shape of highest posterior density among 13 ellipticities and three sizes at the present centre."""
    e, deviation = shape_lattice()
    sizes = prior.log_scale_length + deviation * prior.log_scale_length_sigma
    heights, norm = correlator.correlate(e, sizes, correlator.displaced_to(np.zeros((1, 2))))
    if not np.any(heights > 0):
        return None
    reached = np.where(norm > 0, norm, np.inf)
    score = np.maximum(heights[:, 0], 0) ** 2 / (2 * reached) - 0.5 * deviation**2
    best = int(np.argmax(score))
    return complex(e[best]), float(sizes[best])


def _climb(
    correlator: Correlator, prior: ShapePrior, ellipticity: complex, log_scale_length: float
) -> BestFit | None:
    """Climb from a start at the correlator's centre; None where the flux turns negative."""
    ascent = _Posterior(correlator, prior)
    summit = climb(ascent, ascent.start(ellipticity, log_scale_length), _SCHEDULE)
    best = summit.point
    if best.flux <= 0:
        return None
    if best.centre is not correlator.centre:
        correlator.move_to(best.centre)
    is_at_edge = abs(best.ellipticity) > 0.999 * ascent.largest
    return BestFit(
        flux=best.flux,
        position=best.centre,
        ellipticity=best.ellipticity,
        log_scale_length=best.log_scale_length,
        # Where the coverage is sparse, truncation leaves eigenvalues at or below zero.
        information=with_eigenvalue_floor(best.information),
        position_information=best.position_information,
        has_converged=summit.ending is Ending.CONVERGED
        or (summit.ending is Ending.NO_GAIN and is_at_edge),
    )


@dataclass(frozen=True)
class _Evaluated:
    """Log posterior of a shape at a position, at the best flux, and its derivatives."""

    centre: Float[Array, " 2"]
    ellipticity: complex
    log_scale_length: float
    flux: float
    log_posterior: float
    gradient: Float[Array, " 4"]
    information: Float[Array, "4 4"]
    pull: Float[Array, " 2"]
    position_information: Float[Array, "2 2"]


class _Posterior(Ascent[_Evaluated, tuple[Array, Array]]):
    """The log posterior of one galaxy as a function to climb; each trial moves the correlator."""

    def __init__(self, correlator: Correlator, prior: ShapePrior) -> None:
        self._correlator, self._prior = correlator, prior
        self._longest = search_radius(correlator, prior)
        self.largest = min(LARGEST_ELLIPTICITY, prior.ellipticity.maximum * (1 - 1e-6))

    def start(self, ellipticity: complex, log_scale_length: float) -> _Evaluated:
        """Evaluate the start at the correlator's centre."""
        e = _inside(ellipticity, self.largest)
        return _evaluate(self._correlator, self._prior, e, log_scale_length)

    def step(self, point: _Evaluated, damping: float) -> tuple[tuple[Array, Array], float] | None:
        """Return the steps of shape and position, which decouple; None where the flux is not positive."""
        if point.flux <= 0:
            return None
        information, gradient = _within_disc(point, self.largest)
        step = np.linalg.solve(_damped(information, damping), gradient)
        shift = np.linalg.solve(_damped(point.position_information, damping), point.pull)
        return (step, shift), float(gradient @ step + point.pull @ shift)

    def height(self, point: _Evaluated) -> float:
        """Return the log posterior."""
        return point.log_posterior

    def trial(self, point: _Evaluated, step: tuple[Array, Array]) -> _Evaluated:
        """Evaluate the galaxy after steps of shape and position, neither of them too long."""
        shape, shift = step
        self._correlator.move_to(point.centre + _shortened(shift, self._longest))
        e = _inside(point.ellipticity + complex(shape[1], shape[2]), self.largest)
        log_scale_length = point.log_scale_length + float(np.clip(shape[3], -0.7, 0.7))
        return _evaluate(self._correlator, self._prior, e, log_scale_length)


def _within_disc(
    point: _Evaluated, largest: float
) -> tuple[Float[Array, "4 4"], Float[Array, " 4"]]:
    """Fisher matrix and gradient; those along the edge where the gradient points out of the disc of ellipticities."""
    e = point.ellipticity
    if abs(e) < largest * (1 - 1e-9):
        return point.information, point.gradient
    outward = np.array([0, e.real, e.imag, 0]) / abs(e)
    drawn = float(outward @ point.gradient)
    if drawn <= 0:
        return point.information, point.gradient
    along = np.array([0, -e.imag, e.real, 0]) / abs(e)
    rest = np.eye(4) - np.outer(outward, outward)
    information = rest @ point.information @ rest
    information += float(outward @ point.information @ outward) * np.outer(outward, outward)
    # Along the edge the outward slope turns into a curvature.
    information += drawn / abs(e) * np.outer(along, along)
    return information, rest @ point.gradient


def _damped(information: Float[Array, "n n"], damping: float) -> Float[Array, "n n"]:
    # The last term keeps the matrix of a single baseline from being singular.
    scale = np.diag(information)
    return information + damping * np.diag(scale) + 1e-12 * float(scale.max()) * np.eye(len(scale))


def _evaluate(
    correlator: Correlator, prior: ShapePrior, ellipticity: complex, log_scale_length: float
) -> _Evaluated:
    """Log posterior at the best flux, its gradient and Fisher information, at the correlator's centre."""
    form = correlator.form(ellipticity, log_scale_length)
    derivatives = correlator.form_derivatives(ellipticity, log_scale_length)
    sums = correlator.normal_sums(form, derivatives)
    norm = sums.norm
    if norm <= 0:  # the baselines do not reach the template: it is never better than another
        return _Evaluated(
            correlator.centre,
            ellipticity,
            log_scale_length,
            0.0,
            -math.inf,
            np.zeros(4),
            np.eye(4),
            np.zeros(2),
            np.eye(2),
        )
    products, gram = sums.products, sums.gram
    by_flux = (correlator.flux_unit / prior.flux_sigma) ** 2
    expected = prior.flux / correlator.flux_unit
    flux = (float(products[0]) + by_flux * expected) / (norm + by_flux)
    deviation = (log_scale_length - prior.log_scale_length) / prior.log_scale_length_sigma

    amplitudes = np.array([1.0, flux, flux, flux])
    information = gram * np.outer(amplitudes, amplitudes)
    gradient = amplitudes * (products - flux * gram[0])
    information[0, 0] += by_flux
    gradient[0] = 0.0
    information[3, 3] += 1 / prior.log_scale_length_sigma**2
    gradient[3] -= deviation / prior.log_scale_length_sigma
    by_e = prior.ellipticity_sigma**-2
    information[1, 1] += by_e
    information[2, 2] += by_e
    gradient[1] -= by_e * ellipticity.real
    gradient[2] -= by_e * ellipticity.imag
    by_x = (correlator.length / prior.position_sigma) ** 2
    penalty = deviation**2 + by_e * abs(ellipticity) ** 2
    penalty += by_x * float(correlator.centre @ correlator.centre)
    return _Evaluated(
        centre=correlator.centre,
        ellipticity=ellipticity,
        log_scale_length=log_scale_length,
        flux=flux,
        log_posterior=0.5 * (flux**2 * (norm + by_flux) - penalty),
        gradient=gradient,
        information=information,
        pull=flux * sums.position_gradient - by_x * correlator.centre,
        position_information=flux**2 * sums.position_curvature + by_x * np.eye(2),
    )


def _inside(ellipticity: complex, largest: float) -> complex:
    modulus = abs(ellipticity)
    return ellipticity if modulus <= largest else ellipticity * (largest / modulus)


def _shortened(step: Float[Array, " 2"], longest: float) -> Float[Array, " 2"]:
    length = float(np.hypot(*step))
    return step if length <= longest else step * (longest / length)
