r"""Moments of a galaxy's visibility function: no profile, no prior, linear in the data.

With V the galaxy's visibility function about its own centre, rho = u^2 + v^2, a = u^2 - v^2, b = 2 u v and
f = exp(-rho/2 s^2), everything over s,

.. math::
    M_1 = \int a f V,\quad M_2 = \int b f V,\quad M_R = \int \rho f V

over half of the uv plane. A shear g maps V(k) to V((1 + G) k), G = ((g1, g2), (g2, -g1)), to first order; by parts

.. math::
    \frac{\partial M_1}{\partial g_1} = -\int (2 \rho - a^2) f V,\quad
    \frac{\partial M_1}{\partial g_2} = \frac{\partial M_2}{\partial g_1} = \int a b f V,\quad
    \frac{\partial M_2}{\partial g_2} = -\int (2 \rho - b^2) f V.

These are weighted sums of the data too, and linear: sum M over sum of the derivatives is a shear without noise bias,
whatever the profile (moments with a weight in Fourier space are those of Bernstein & Armstrong 2014 and Bernstein et
al. 2016).

**Third order.** Of galaxies that lie in all directions the average V is a function of rho alone, and behind a shear
g the average M is R g + K g |g|^2 with

.. math:: R = \int (\rho^2/2 - 2 \rho) f V,\quad K = \int (\rho^4/16 - \rho^3 + 7\rho^2/2 - 2\rho) f V:

rho becomes rho (1 + |g|^2 + 2 |g| cos 2 phi)/(1 - |g|^2), expanded and integrated by parts. The derivatives of
galaxies that are lensed already are (R + 3 K |g|^2) (1 - |g|^2), for shears do not add up but compose; so M over R
comes out as g (1 + (1 - 2 K/R) |g|^2).

**Gaps.** V is not measured everywhere; but a galaxy is small, and of all weights on the data that sum to M for anything
inside a disc those of least noise are taken (``fit.deconvolution``).

**The centre** is the catalogue's, never one found in the same data: noise moves that one by half a scale length at a
signal-to-noise ratio of ten, where it is also what makes the moments. Errors of the catalogue's position that are
Gaussian, of variance sigma^2 in l and in m, multiply V by exp(-2 pi^2 sigma^2 k^2) on average; the weights are divided
by that, which is exact for any size of the errors.
"""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.shapes.deconvolution import Disc, EvenPart
from uvshear.typing import Array, Complex, Float

SCALE = 15e3
"""s [wavelengths]. Larger weights have more noise for galaxies of an arcsecond, smaller ones too."""

REACH = 6.0
"""Longest baseline that takes part, over s: what the weight has left there, 1e-8 and its responses 1e-5, is lost."""

MOST_SCATTER = 0.25
"""2 pi^2 sigma^2 s^2 at most: at 1/2 the weights would not end."""


@dataclass(frozen=True)
class Moments:
    """Moments [Jy].

    Parameters
    ----------
    shape
        M_1, M_2.
    response
        Their derivatives by g1, g2 (the second index), with noise of their own, of mean zero.
    third
        K.
    size
        M_R.
    covariance
        Of M_1, M_2, M_R by noise.
    """

    shape: Float[Array, " 2"]
    response: Float[Array, "2 2"]
    third: float
    size: float
    covariance: Float[Array, "3 3"]


class MomentFunctional:
    """The moments' weights on the cells of one facet and beam; any number of sources share it."""

    def __init__(
        self,
        uv: Float[Array, "cell 2"],
        power: Float[Array, " cell"],
        width: float,
        position_sigma: float = 0.0,
    ) -> None:
        """For a facet ``width`` wide, and errors of the centre of ``position_sigma`` in l and in m [rad]."""
        scatter = 2 * (math.pi * position_sigma * SCALE) ** 2
        if scatter >= MOST_SCATTER:
            raise InputError(
                f"errors of the positions of {position_sigma / ARCSEC:.2g} arcsec; moments bear up to"
                f" {math.sqrt(MOST_SCATTER / 2) / math.pi / SCALE / ARCSEC:.2g}"
            )
        longest = REACH * SCALE / math.sqrt(1 - 2 * scatter)
        self._cells = np.flatnonzero(np.hypot(*uv.T) <= longest)
        near, power = uv[self._cells], power[self._cells]
        x, y = near.T / SCALE
        rho, a, b = x * x + y * y, x * x - y * y, 2 * x * y
        # Over half of the plane: the cell at the origin stands for itself alone.
        area = np.where(rho > 0, 1.0, 0.5) / (width * SCALE) ** 2
        weight = area * np.exp(-rho * (0.5 - scatter))
        third = rho * (rho * (rho * (rho / 16 - 1) + 3.5) - 2)
        targets = weight * np.stack([a, b, a * a - 2 * rho, a * b, b * b - 2 * rho, third, rho])
        even = EvenPart(Disc(width, longest), near, power)
        self._weights = even.weights(even.of_cells(targets))
        shown = self._weights[[0, 1, 6]]
        self._covariance = (shown * np.abs(power)) @ shown.T

    def measure(self, correlation: Complex[Array, " cell"]) -> Moments:
        """Moments of one facet's data about its centre."""
        m1, m2, r11, r12, r22, third, size = (
            self._weights @ correlation[self._cells].real
        ).tolist()
        return Moments(
            shape=np.array([m1, m2]),
            response=np.array([[r11, r12], [r12, r22]]),
            third=third,
            size=size,
            covariance=self._covariance,
        )
