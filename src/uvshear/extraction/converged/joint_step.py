"""One Gauss-Newton step of all sources at once.

Fitted in turn, overlapping galaxies move slowly along the ridge of their joint likelihood, and the broad plateau of a
beam with natural weights slows down whole neighbourhoods. The gradients of the step are exact, from the facets; the
couplings (``couplings``) only have to give an ascent direction.
"""

import math
from collections.abc import Sequence

import numpy as np
from scipy.sparse.linalg import LinearOperator, cg

from uvshear.extraction.converged.couplings import Couplings, couple
from uvshear.extraction.converged.moving_sky import Given, Move, MovingSky, SkyCrew
from uvshear.extraction.converged.sky_state import Linearisation, SkyState
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.normal_equations import NormalEquations, normal_equations
from uvshear.shapes.template import PARAMETERS, difference
from uvshear.typing import Array, Bool, Float

DAMPING = 0.2
"""Damping of the step. It keeps the matrix positive, although this is truncated at some distance, and it keeps steps
short where sources are hard to separate. Along such ridges groups take checked steps of their own
(``shapes.blend``)."""

SMALLEST_STEP = 0.2
"""Change of a source, in units of the tolerance, below which the source is not moved."""

AT_THE_EDGE = 0.99
"""Ellipticity, over the largest that is allowed, above which a source does not take part in the step."""

SMALLEST_INFORMATION = 1e-200
"""Diagonal element of a Fisher matrix, in the unit of its parameter, that is no more than rounding."""

_SOLVED = 1e-3
_MOST_ITERATIONS = 200

_FIXED = 1e9


def step_jointly(
    sky: MovingSky,
    couplings: Couplings | None,
    tolerance: float,
    crew: SkyCrew,
) -> tuple[Float[Array, " source"], Linearisation]:
    """Let all sources but those in groups take one Gauss-Newton step together.

    If ``couplings`` are given, they are scaled with the fluxes; otherwise they are computed. The function returns the
    change of each source in units of the noise, and the equations that were solved.
    """
    now = sky.now
    equations = tuple(crew.map(_equations, range(len(now.fits))))
    if couplings is None:
        couplings = couple(now, crew)
    is_fixed = now.neighbourhood.is_grouped | np.array(
        [_is_stuck(now, source) for source in range(len(now.fits))]
    )
    flux = np.array([fit.flux for fit in now.fits])
    steps = solve_jointly(equations, couplings, flux, is_fixed)
    after = [
        source.after_step(fit, step)
        for source, fit, step in zip(now.sources, now.fits, steps, strict=True)
    ]
    length = np.array([_step_length(now, equations[k], k, new) for k, new in enumerate(after)])
    movers = np.flatnonzero(length > SMALLEST_STEP * tolerance).tolist()
    sky.move([Move([k], Given(after[k])) for k in movers], crew)
    return length, Linearisation(equations, couplings)


def _equations(sky: MovingSky, k: int) -> NormalEquations:
    now = sky.now
    source = now.sources[k]
    return normal_equations(now.residual(k), source.prior, source.profile, now.fits[k])


def _is_stuck(now: SkyState, source: int) -> bool:
    """Whether no step can improve a source: it was not found and stands as expected, or it is at the limit of e."""
    fit, largest = now.fits[source], now.sources[source].prior.ellipticity.maximum
    return fit.snr <= 0 or abs(fit.ellipticity) > AT_THE_EDGE * largest


def _step_length(now: SkyState, equations: NormalEquations, source: int, new: GalaxyFit) -> float:
    """Change of a source that takes a step, in units of the noise, by its own block of the Fisher matrix."""
    if (old := now.fits[source]) is new:
        return 0.0
    step = difference(new, old)
    _, precision = now.sources[source].prior.pull(old)
    information = equations.information - np.diag(precision)
    return math.sqrt(max(float(step @ information @ step), 0.0))


def solve_jointly(
    equations: Sequence[NormalEquations],
    couplings: Couplings,
    flux: Float[Array, " source"],
    is_fixed: Bool[Array, " source"],
) -> Float[Array, "source 6"]:
    """Solve (F + DAMPING diag F) step = gradient by conjugate gradients, with some sources fixed.

    A system that has no solution moves no source. Parameters on which there is no information stay as they are; that
    of a source without flux, for example, may be zero or less by rounding.
    """
    own = np.array([source.information for source in equations])
    diagonal = np.einsum("sii->si", own)
    is_known = diagonal > SMALLEST_INFORMATION
    gradient = np.where(is_known, [source.gradient for source in equations], 0.0)
    scale = np.sqrt(np.where(is_known, diagonal, 1.0))
    own = np.where(is_known[:, :, None] & is_known[:, None, :], own, 0.0)
    own = own / (scale[:, :, None] * scale[:, None, :])
    own += np.where(is_fixed, _FIXED, DAMPING)[:, None, None] * np.eye(PARAMETERS)
    near = couplings.blocks_with_diagonal(own, scale, flux)
    inverse = np.linalg.inv(own)

    def multiply(x: Float[Array, " n"]) -> Float[Array, " n"]:
        product = (near @ x).reshape(-1, PARAMETERS)
        flux = x.reshape(-1, PARAMETERS)[:, 0] / scale[:, 0]
        product[:, 0] += (couplings.far @ flux) / scale[:, 0]
        return product.ravel()

    def precondition(x: Float[Array, " n"]) -> Float[Array, " n"]:
        return np.einsum("sij,sj->si", inverse, x.reshape(-1, PARAMETERS)).ravel()

    matrix = LinearOperator(near.shape, matvec=multiply, dtype=float)
    preconditioner = LinearOperator(near.shape, matvec=precondition, dtype=float)
    right = (gradient / scale).ravel()
    # Where the couplings, which are approximate, make the matrix indefinite, the iteration diverges.
    with np.errstate(over="ignore", invalid="ignore"):
        solution, _ = cg(matrix, right, rtol=_SOLVED, maxiter=_MOST_ITERATIONS, M=preconditioner)
    if not np.isfinite(solution).all():
        solution = np.zeros(len(right))
    return solution.reshape(-1, PARAMETERS) / scale
