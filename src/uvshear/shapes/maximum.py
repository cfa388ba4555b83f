"""The maximum of the likelihood: a robust start, then damped Gauss-Newton steps."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.shapes.correlator import Correlator
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Complex, Float

LARGEST_ELLIPTICITY = 0.95
_TOLERANCE = 1e-3
_MOST_STEPS = 80
_LEAST_DAMPING, _MOST_DAMPING = 1e-3, 1e6
_UPPER = ((0, 0), (0, 1), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3))


@dataclass(frozen=True)
class BestFit:
    """Most likely parameters in the correlator's units, the size under its prior.

    ``information`` is the Fisher matrix of (flux, e1, e2, ln alpha), the prior on ln alpha included; that of the
    position is ``position_information``: the two decouple.
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
        """S sqrt<m, m>: the flux comes first in the Fisher matrix."""
        return self.flux * math.sqrt(float(self.information[0, 0]))


@dataclass(frozen=True)
class _State:
    ellipticity: complex
    log_scale_length: float
    flux: float
    log_posterior: float
    gradient: Float[Array, " 4"]
    information: Float[Array, "4 4"]
    pull: Float[Array, " 2"]
    position_information: Float[Array, "2 2"]


def maximise_likelihood(
    correlator: Correlator, prior: ShapePrior, start: GalaxyFit | None = None
) -> BestFit | None:
    """Find the best galaxy; leave the correlator centred on it. None where no positive flux fits.

    The cross-correlation has many peaks: without a ``start`` it is looked at over the whole prior of the
    position before any step is taken, and over a coarse lattice of shapes at its highest peak.
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
    """Radius of the position's prior in the correlator's units."""
    if prior.position_radius is not None:
        return prior.position_radius / correlator.length
    return peak_width(correlator, prior)


def peak_width(correlator: Correlator, prior: ShapePrior) -> float:
    """Gaussian sigma of the autocorrelation of the circular median galaxy."""
    form = correlator.form(0j, prior.log_scale_length)
    sums = correlator.normal_sums(form, np.zeros((3, 3)))
    norm, curvature = float(sums[4]), float(sums[16] + sums[18])
    return math.sqrt(2 * norm / curvature) if norm > 0 and curvature > 0 else 1.0


def _highest_peak(correlator: Correlator, prior: ShapePrior) -> Float[Array, " 2"]:
    """Highest cross-correlation with the circular median galaxy on a hexagonal lattice over the prior."""
    spacing = 0.7 * peak_width(correlator, prior)
    nodes = hexagonal_lattice(search_radius(correlator, prior), spacing)
    displaced = correlator.displaced_to(nodes)
    heights, _ = correlator.correlate(np.array([0j]), np.array([prior.log_scale_length]), displaced)
    return nodes[np.argmax(heights[0])]


def hexagonal_lattice(radius: float, spacing: float) -> Float[Array, "sample 2"]:
    """Points of a hexagonal lattice within a radius of the origin, which is one of them."""
    reach = math.ceil(radius / spacing) + 1
    i, j = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    points = np.stack([i + 0.5 * j, math.sqrt(0.75) * j], axis=-1).reshape(-1, 2) * spacing
    return points[np.hypot(*points.T) <= radius * (1 + 1e-9)]


def _best_of_lattice(correlator: Correlator, prior: ShapePrior) -> tuple[complex, float] | None:
    """Shape of the highest posterior among 13 ellipticities and three sizes, at the present centre."""
    e, deviation = shape_lattice()
    sizes = prior.log_scale_length + deviation * prior.log_scale_length_sigma
    heights, norm = correlator.correlate(e, sizes, correlator.displaced_to(np.zeros((1, 2))))
    if not np.any(heights > 0):
        return None
    reached = np.where(norm > 0, norm, np.inf)
    score = np.maximum(heights[:, 0], 0) ** 2 / (2 * reached) - 0.5 * deviation**2
    best = int(np.argmax(score))
    return complex(e[best]), float(sizes[best])


def shape_lattice() -> tuple[Complex[Array, " sample"], Float[Array, " sample"]]:
    """Ellipticities in all directions, each with three sizes in standard deviations of the prior."""
    angles = np.exp(2j * math.pi * np.arange(6) / 6)
    ellipticity = np.concatenate([[0], 0.3 * angles, 0.6 * angles * np.exp(1j * math.pi / 6)])
    steps = np.array([-1.0, 0.0, 1.0])
    return np.repeat(ellipticity, 3), np.tile(steps, len(ellipticity))


def _climb(
    correlator: Correlator, prior: ShapePrior, ellipticity: complex, log_scale_length: float
) -> BestFit | None:
    """Levenberg-Marquardt from a start at the correlator's centre; None where the flux turns negative."""
    longest = search_radius(correlator, prior)
    largest = min(LARGEST_ELLIPTICITY, prior.ellipticity.maximum * (1 - 1e-6))
    state = _evaluate(correlator, prior, _inside(ellipticity, largest), log_scale_length)
    damping, has_converged = _LEAST_DAMPING, False
    for _ in range(_MOST_STEPS):
        if state.flux <= 0:
            return None
        information, gradient = _within_disc(state, largest)
        step = np.linalg.solve(_damped(information, damping), gradient)
        shift = np.linalg.solve(_damped(state.position_information, damping), state.pull)
        if gradient @ step + state.pull @ shift < _TOLERANCE:
            has_converged = True
            break
        before = correlator.centre
        correlator.move_to(before + _shortened(shift, longest))
        e = _inside(state.ellipticity + complex(step[1], step[2]), largest)
        size = state.log_scale_length + float(np.clip(step[3], -0.7, 0.7))
        trial = _evaluate(correlator, prior, e, size)
        gain = trial.log_posterior - state.log_posterior
        if gain > 0:
            state, damping = trial, max(damping / 10, _LEAST_DAMPING)
        else:
            correlator.move_to(before)
            damping *= 10
        # A step may promise more than it can keep; one that was short and gained nothing was at the top.
        if abs(gain) < _TOLERANCE and (gain > 0 or damping > 1):
            has_converged = True
            break
        if damping > _MOST_DAMPING:
            has_converged = abs(state.ellipticity) > 0.999 * largest
            break
    return BestFit(
        flux=state.flux,
        position=correlator.centre,
        ellipticity=state.ellipticity,
        log_scale_length=state.log_scale_length,
        information=_made_positive(state.information),
        position_information=state.position_information,
        has_converged=has_converged,
    )


def _within_disc(state: _State, largest: float) -> tuple[Float[Array, "4 4"], Float[Array, " 4"]]:
    """Fisher matrix and gradient; at the edge of the disc of ellipticities, drawn outwards, those along the edge."""
    e = state.ellipticity
    if abs(e) < largest * (1 - 1e-9):
        return state.information, state.gradient
    outward = np.array([0, e.real, e.imag, 0]) / abs(e)
    drawn = float(outward @ state.gradient)
    if drawn <= 0:
        return state.information, state.gradient
    along = np.array([0, -e.imag, e.real, 0]) / abs(e)
    rest = np.eye(4) - np.outer(outward, outward)
    information = rest @ state.information @ rest
    information += float(outward @ state.information @ outward) * np.outer(outward, outward)
    # Along the edge the outward slope turns into a curvature.
    information += drawn / abs(e) * np.outer(along, along)
    return information, rest @ state.gradient


def _made_positive(information: Float[Array, "n n"]) -> Float[Array, "n n"]:
    """Raise eigenvalues that truncation has left at or below zero, where the coverage is sparse."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-30))
    values, vectors = np.linalg.eigh(information / np.outer(scale, scale))
    return (vectors * np.maximum(values, 1e-6)) @ vectors.T * np.outer(scale, scale)


def _damped(information: Float[Array, "n n"], damping: float) -> Float[Array, "n n"]:
    # The second term keeps a single baseline's matrix from being singular.
    scale = np.diag(information)
    return information + damping * np.diag(scale) + 1e-12 * float(scale.max()) * np.eye(len(scale))


def _evaluate(
    correlator: Correlator, prior: ShapePrior, ellipticity: complex, log_scale_length: float
) -> _State:
    """Posterior at the best flux, its gradient and Fisher information, at the correlator's centre."""
    form = correlator.form(ellipticity, log_scale_length)
    derivatives = correlator.form_derivatives(ellipticity, log_scale_length)
    sums = correlator.normal_sums(form, derivatives)
    products, upper = sums[:4], sums[4:14]
    response = np.empty((4, 4))
    for (i, j), value in zip(_UPPER, upper, strict=True):
        response[i, j] = response[j, i] = value
    norm = float(response[0, 0])
    if norm <= 0:  # a template out of the reach of the baselines: never better than another
        return _State(
            ellipticity,
            log_scale_length,
            0.0,
            -math.inf,
            np.zeros(4),
            np.eye(4),
            np.zeros(2),
            np.eye(2),
        )
    by_flux = (correlator.flux_unit / prior.flux_sigma) ** 2
    expected = prior.flux / correlator.flux_unit
    flux = (float(products[0]) + by_flux * expected) / (norm + by_flux)
    deviation = (log_scale_length - prior.log_scale_length) / prior.log_scale_length_sigma

    amplitudes = np.array([1.0, flux, flux, flux])
    information = response * np.outer(amplitudes, amplitudes)
    gradient = amplitudes * (products - flux * response[0])
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
    curvature = sums[[16, 17, 17, 18]].reshape(2, 2)
    penalty = deviation**2 + by_e * abs(ellipticity) ** 2
    penalty += by_x * float(correlator.centre @ correlator.centre)
    return _State(
        ellipticity=ellipticity,
        log_scale_length=log_scale_length,
        flux=flux,
        log_posterior=0.5 * (flux**2 * (norm + by_flux) - penalty),
        gradient=gradient,
        information=information,
        pull=flux * sums[14:16] - by_x * correlator.centre,
        position_information=flux**2 * curvature + by_x * np.eye(2),
    )


def _inside(ellipticity: complex, largest: float) -> complex:
    modulus = abs(ellipticity)
    return ellipticity if modulus <= largest else ellipticity * (largest / modulus)


def _shortened(step: Float[Array, " 2"], longest: float) -> Float[Array, " 2"]:
    length = float(np.hypot(*step))
    return step if length <= longest else step * (longest / length)


def shape_covariance(best: BestFit) -> Float[Array, "3 3"]:
    """Of (e1, e2, ln alpha), the flux marginalised, by the Fisher matrix."""
    return np.linalg.inv(best.information)[1:, 1:]
