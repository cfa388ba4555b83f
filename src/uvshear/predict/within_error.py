"""Visibilities of galaxies to within an error, in whichever way is fastest."""

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Galaxies, Profile
from uvshear.predict.by_grid import GridPrediction
from uvshear.predict.direct import largest_flux, precision_within
from uvshear.predict.direct_sum import DirectSum
from uvshear.predict.losses import Losses
from uvshear.predict.prediction import Prediction
from uvshear.typing import Array, Complex, Float


def predict_within_error(
    galaxies: Galaxies,
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    error: float,
    profile: Profile,
    executor: Executor = SERIAL,
    losses: Losses | None = None,
) -> Complex[Array, "row chan"]:
    """Predict the visibilities of all galaxies [Jy] with a root mean square error of ``error`` [Jy] at most.

    Images do not represent losses that differ from source to source: where there are any, galaxies are summed, in
    single precision if the error allows it.

    Parameters
    ----------
    galaxies, uvw, frequency, profile, executor, losses
        As for ``predict_visibilities``.
    error
        Error that is allowed [Jy]; with 0 the sum is exact.
    """
    planned = plan_within_error(galaxies, uvw, frequency, error, profile, executor, losses)
    return planned.visibilities(executor)


def plan_within_error(
    galaxies: Galaxies,
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    error: float,
    profile: Profile,
    executor: Executor = SERIAL,
    losses: Losses | None = None,
) -> Prediction:
    """Plan what ``predict_within_error`` does, whose arguments these are."""
    if losses is not None:
        dtype: type[np.floating] = precision_within(error, largest_flux(galaxies, frequency))
        return DirectSum(galaxies, uvw, frequency, profile, losses, dtype)
    return GridPrediction.planned(galaxies, uvw, frequency, error, profile, executor)
