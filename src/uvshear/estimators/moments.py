"""Shear from moments of visibility functions: sum of the moments over the sum of their responses."""

import numpy as np

from uvshear.estimators.ratio import Responses
from uvshear.typing import Array, Float

ELLIPTICITY_SCATTER = 0.3
"""Standard deviation of a noise-free galaxy's M over its R."""

RESPONSE = 1.5
"""R over the flux for a galaxy of an arcsecond, in the units of the moments."""


def moment_weight(
    flux: Float[Array, " source"], variance: Float[Array, " source"]
) -> Float[Array, " source"]:
    r"""Weight of a galaxy's moments, from its catalogue's flux [Jy] and the noise variance of M [Jy^2].

    .. math:: w = \frac{R}{\sigma_e^2 R^2 + \sigma_M^2},\quad R = 1.5 S

    A function of what neither the shear nor the noise of the moments changes: a fitted flux would not do.
    """
    response = RESPONSE * flux
    return response / (ELLIPTICITY_SCATTER**2 * response**2 + variance)


def about_shear(moments: Responses, third: Float[Array, " source"], about: complex) -> Responses:
    r"""Expand moments about an estimate of the shear: exact to the fourth order where that is to the second.

    .. math:: \sum M = \sum \big[R + (\mathrm{tr} R/2 - 2 K) |g|^2\big]\, g

    (``fit.moments``); ``third`` is K [Jy]. Without an estimate it is the plain ratio.
    """
    own = np.trace(moments.response, axis1=-2, axis2=-1) / 2
    more = (own - 2 * third) * abs(about) ** 2
    response = moments.response + more[:, None, None] * np.eye(2)
    value = moments.value - response @ np.array([about.real, about.imag])
    return Responses(value, response, about)
