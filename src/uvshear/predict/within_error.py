"""Visibilities of galaxies to within an error, in whichever way is fastest."""

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Galaxies, Profile
from uvshear.predict.by_grid import predict_by_grid
from uvshear.predict.direct import largest_flux, precision_within, predict_visibilities
from uvshear.predict.losses import Losses
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
    if losses is not None:
        dtype: type[np.floating] = precision_within(error, largest_flux(galaxies, frequency))
        return predict_visibilities(galaxies, uvw, frequency, profile, executor, losses, dtype)
    return predict_by_grid(galaxies, uvw, frequency, error, profile, executor)
