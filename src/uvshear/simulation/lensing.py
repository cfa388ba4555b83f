"""The effect of a lens on galaxies."""

from dataclasses import replace

import numpy as np

from uvshear.errors import InputError
from uvshear.galaxy.galaxies import Galaxies
from uvshear.geometry.ellipticity import add_shear, sheared_scale_length
from uvshear.typing import Array, Complex


def shear_galaxies(galaxies: Galaxies, g: complex | Complex[Array, " source"]) -> Galaxies:
    r"""Apply a reduced shear to galaxies: a linear map of each galaxy's image about its centre.

    .. math::
        e' = \frac{e + g}{1 + g^* e},\quad
        \alpha' = \alpha \sqrt{\frac{1 - |e'|^2}{1 - |e|^2}}

    Positions and fluxes are unchanged: the map is that of a lens of unit magnification.

    Parameters
    ----------
    g
        Reduced shear in the (l, m) frame, abs(g) < 1: one number, or one for each galaxy. A shear in the sky frame is
        converted by :func:`uvshear.geometry.ellipticity.to_field_frame`.
    """
    e = _sheared(galaxies, g)
    scale_length = sheared_scale_length(galaxies.scale_length, galaxies.ellipticity, e)
    return replace(galaxies, ellipticity=e, scale_length=scale_length)


def shear_at_fixed_scale_length(
    galaxies: Galaxies, g: complex | Complex[Array, " source"]
) -> Galaxies:
    r"""Shear the ellipticities of galaxies but keep their scale lengths, as Rivi & Miller 2018 do.

    .. math:: e' = \frac{e + g}{1 + g^* e},\quad \alpha' = \alpha

    Parameters
    ----------
    g
        Reduced shear in the (l, m) frame, abs(g) < 1: one number, or one for each galaxy. A shear in the sky frame is
        converted by :func:`uvshear.geometry.ellipticity.to_field_frame`.

    References
    ----------
    Rivi & Miller 2018, section 5.

    Notes
    -----
    No lens does this: estimators that use the response to a shear have a spurious m of -0.07 to -0.14 on such
    galaxies. The function serves only to reproduce the paper.
    """
    return replace(galaxies, ellipticity=_sheared(galaxies, g))


def _sheared(
    galaxies: Galaxies, g: complex | Complex[Array, " source"]
) -> Complex[Array, " source"]:
    if np.any(np.abs(g) >= 1):
        raise InputError("a reduced shear has |g| >= 1; it must be below 1")
    return add_shear(galaxies.ellipticity, g)
