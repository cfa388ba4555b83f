"""The fit of an unresolved source: flux and position."""

import math

import numpy as np

from uvshear.galaxy.profile import Profile
from uvshear.interferometer.facet import Facet
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.maximum import hexagonal_lattice, peak_width
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Float

_STEPS = 20
_TOLERANCE = 1e-4


class Point(Profile):
    """A point source: the same on all baselines."""

    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """1 everywhere."""
        return np.ones_like(q)

    def envelope_slope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """0 everywhere."""
        return np.zeros_like(q)


def fit_point(facet: Facet, prior: ShapePrior, start: GalaxyFit | None = None) -> GalaxyFit | None:
    """Most likely point source. None where no positive flux fits, or only far from where it is expected."""
    if len(facet.uv) == 0 or float(np.sum(facet.power)) <= 0:
        return None
    correlator = Correlator(facet, Point(), np.float64)
    width = peak_width(correlator, prior)
    given = prior.position_radius
    radius = width if given is None else given / correlator.length
    if start is None:
        nodes = hexagonal_lattice(radius, 0.7 * width)
        displaced = correlator.displaced_to(nodes)
        position = nodes[np.argmax(displaced.sum(axis=1))]
    else:
        position = start.offset / correlator.length
    flux, norm = 0.0, 1.0
    for _ in range(_STEPS):
        correlator.move_to(position)
        sums = correlator.normal_sums(np.zeros(3), np.zeros((3, 3)))
        norm = float(sums[4])
        flux = float(sums[0]) / norm
        if flux <= 0:
            return None
        curvature = flux * sums[[16, 17, 17, 18]].reshape(2, 2)
        step = np.linalg.lstsq(curvature, sums[14:16], rcond=1e-9)[0]
        length = float(np.hypot(*step))
        position = position + step * min(1.0, width / max(length, 1e-30))
        if flux * float(step @ curvature @ step) < _TOLERANCE**2:
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
