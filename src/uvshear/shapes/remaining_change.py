"""What another major cycle would change in a source, as a flag and as a part of its error."""

import math
from dataclasses import dataclass, replace

import numpy as np

from uvshear.shapes.measurement import FitFlag, ShapeMeasurement

NOTICEABLE = 0.5
"""Change of a model that another major cycle would bring, in units of the noise, from which on the source has not
converged: each of its six parameters is then still off by about a fifth of its error."""


@dataclass(frozen=True)
class RemainingChange:
    """Estimate of what another major cycle would change in a source.

    Parameters
    ----------
    model
        Change of its model by another major cycle, in units of the noise.
    ellipticity
        Change of its ellipticity by all further major cycles.
    """

    model: float
    ellipticity: complex


def with_remaining_change(shape: ShapeMeasurement, change: RemainingChange) -> ShapeMeasurement:
    """Return a shape whose covariance includes the change, flagged where the change is noticeable."""
    quality = replace(shape.quality, remaining_change=change.model)
    flag = shape.flag
    if flag is FitFlag.OK and change.model > NOTICEABLE:
        flag = FitFlag.NOT_CONVERGED
    moved = np.array([change.ellipticity.real, change.ellipticity.imag])
    covariance = shape.covariance
    if math.isfinite(change.model) and np.isfinite(moved).all():
        covariance = covariance + np.outer(moved, moved)
    return replace(shape, quality=quality, flag=flag, covariance=covariance)
