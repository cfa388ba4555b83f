"""The fit of an unresolved source: its flux and its position."""

import math

import numpy as np

from uvshear.galaxy.profile import Profile
from uvshear.interferometer.facet import Facet
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.lattices import hexagonal_lattice
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Float

_MOST_STEPS = 20
_TOLERANCE = 1e-4  # of the error of the position


class Point(Profile):
    """A point source, whose visibilities have the same amplitude on all baselines."""

    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Return 1 everywhere."""
        return np.ones_like(q)

    def envelope_slope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Return 0 everywhere."""
        return np.zeros_like(q)


def fit_point(facet: Facet, prior: ShapePrior, start: GalaxyFit | None = None) -> GalaxyFit | None:
    """Most likely point source; None where no positive flux fits within the prior on the position.

    The steps are plain Gauss-Newton steps no longer than the peak is wide, not damped ones that are checked
    (``numerics.damped_newton``): the norm of a point source is the same everywhere, so that the likelihood has no
    valleys within the peak from which the fit starts, and for a facet of a single baseline, which leaves one direction
    undetermined, the shortest of all steps that solve the singular equations is taken.

    Parameters
    ----------
    facet
        Facet from which all other sources are subtracted.
    prior
        Prior of the source, of which only that on the position is used.
    start
        Point source to start from; without one the fit starts from the highest pixel within the prior.
    """
    if len(facet.uv) == 0 or float(np.sum(facet.power)) <= 0:
        return None
    correlator = Correlator(facet, Point(), np.float64)
    width = correlator.peak_width(prior.log_scale_length)
    given = prior.position_radius
    radius = width if given is None else given / correlator.length
    if start is None:
        nodes = hexagonal_lattice(radius, 0.7 * width)
        displaced = correlator.displaced_to(nodes)
        position = nodes[np.argmax(displaced.sum(axis=1))]
    else:
        position = start.offset / correlator.length
    # Neither the norm nor the curvature depends on the position.
    sums = correlator.normal_sums(np.zeros(3), np.zeros((3, 3)))
    norm, curvature = sums.norm, sums.position_curvature
    inverse = np.linalg.pinv(curvature, rcond=1e-9, hermitian=True)
    flux = 0.0
    for _ in range(_MOST_STEPS):
        product, gradient = correlator.point_at(position)
        flux = product / norm
        if flux <= 0:
            return None
        step = inverse @ gradient / flux
        length = math.hypot(*step)
        position = position + step * min(1.0, width / max(length, 1e-30))
        if flux**2 * float(step @ curvature @ step) < _TOLERANCE**2:
            break
    if np.hypot(*position) > 1.5 * radius:
        return None
    return GalaxyFit(
        flux=flux * correlator.flux_unit,
        offset=position * correlator.length,
        ellipticity=0j,
        scale_length=0.0,
        snr=flux * math.sqrt(norm),
    )
