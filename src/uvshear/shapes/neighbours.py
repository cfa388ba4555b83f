"""Errors of a shape with the parameters of its neighbours marginalised."""

import math
from dataclasses import replace

import numpy as np

from uvshear.shapes.measurement import ShapeMeasurement
from uvshear.typing import Array, Float

FARTHEST = 0.5
"""Largest shift of e by the marginalisation over neighbours, in units of its error. With 1 instead, the scatter of
galaxies at a density of 2.8 per square arcminute is 0.7 per cent larger; with 0.1, slopes are 0.002 lower."""


def with_neighbours_marginalised(
    shape: ShapeMeasurement,
    conditional: Float[Array, "6 6"],
    marginal: Float[Array, "6 6"],
    shift: Float[Array, " 6"],
    information_fraction: float = 1.0,
) -> ShapeMeasurement:
    """Widen the errors of a shape for the uncertainty of its neighbours, and shift e accordingly.

    With conditional = L L^T and C = K K^T the covariance of e of the posterior, the covariance becomes f K L^-1
    marginal L^-T K^T, with f the information fraction: the posterior keeps its own shape. The mean of a posterior of
    covariance C moves by C conditional^-1 times the shift of the likelihood, but by no more than ``FARTHEST`` of its
    errors: beyond that the Fisher matrix is a poor approximation and adds noise of its own.

    Parameters
    ----------
    shape
        Shape measured with the neighbours fixed.
    conditional, marginal
        Fisher covariances of (flux, e1, e2, ln alpha, l, m), with the parameters of the neighbours fixed and
        marginalised.
    shift
        Change of these parameters when the neighbours are free to follow.
    information_fraction
        Fraction of the information of the facet that the posterior has used.
    """
    if not np.all(np.isfinite(shape.covariance)):
        return shape
    e = slice(1, 3)
    own = np.linalg.cholesky(shape.covariance + 1e-30 * np.eye(2))
    matrix = own @ np.linalg.inv(np.linalg.cholesky(conditional[e, e]))
    ratio = np.sqrt(np.diag(marginal) / np.diag(conditional))
    moved = shape.covariance @ np.linalg.inv(conditional[e, e]) @ shift[e]
    errors = math.sqrt(float(moved @ np.linalg.pinv(shape.covariance) @ moved))
    return replace(
        shape,
        ellipticity=shape.ellipticity + moved / max(errors / FARTHEST, 1.0),
        covariance=information_fraction * matrix @ marginal[e, e] @ matrix.T,
        flux_err=shape.flux_err * float(ratio[0]),
        scale_length_err=shape.scale_length_err * float(ratio[3]),
        offset_err=shape.offset_err * ratio[4:6],
    )
