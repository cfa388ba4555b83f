r"""Moments of a galaxy's visibility function: they need no profile and no prior, and are linear in the data.

With V the visibility function of the galaxy about its own centre, rho = u^2 + v^2, a = u^2 - v^2, b = 2 u v and
f = exp(-rho/2 s^2), all coordinates in units of s,

.. math::
    M_1 = \int a f V,\quad M_2 = \int b f V,\quad M_R = \int \rho f V

over half of the uv plane. A shear g maps V(k) to V((1 + G) k), G = ((g1, g2), (g2, -g1)), to first order; by parts

.. math::
    \frac{\partial M_1}{\partial g_1} = -\int (2 \rho - a^2) f V,\quad
    \frac{\partial M_1}{\partial g_2} = \frac{\partial M_2}{\partial g_1} = \int a b f V,\quad
    \frac{\partial M_2}{\partial g_2} = -\int (2 \rho - b^2) f V.

These are weighted sums of the data too, and linear: the sum of M over the sum of the derivatives is a shear without
noise bias, whatever the profile (moments with a weight in Fourier space are those of Bernstein & Armstrong 2014 and
Bernstein et al. 2016).

**Third order.** For galaxies with randomly oriented ellipticities the average V is a function of rho alone, and behind
a shear g the average M is R g + K g |g|^2 with

.. math:: R = \int (\rho^2/2 - 2 \rho) f V,\quad K = \int (\rho^4/16 - \rho^3 + 7\rho^2/2 - 2\rho) f V:

rho becomes rho (1 + |g|^2 + 2 |g| cos 2 phi)/(1 - |g|^2), which is expanded and integrated by parts. The derivatives of
galaxies that are already lensed are (R + 3 K |g|^2) (1 - |g|^2), since shears compose and do not simply add; M over the
derivatives is therefore g (1 + (1 - 2 K/R) |g|^2).

**Gaps.** V is not measured everywhere. But a galaxy is small, and of all weights on the data that sum to M for any
brightness distribution within a disc, those with the least noise are used (``shapes.deconvolution``).

**The centre** is that of the catalogue, never one found in the same data: noise moves such a centre by half a scale
length at a signal-to-noise ratio of ten, and the same noise is in the moments. Gaussian errors of the catalogue's
positions, of variance sigma^2 in l and in m, multiply V by exp(-2 pi^2 sigma^2 k^2) on average; the weights are divided
by this factor, which is exact for errors of any size.
"""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.shapes.deconvolution import Disc, EvenPart
from uvshear.typing import Array, Complex, Float

SCALE = 15e3
"""Width s of the weight [wavelengths]. For galaxies of one arcsecond, larger and smaller widths have more noise."""

REACH = 6.0
"""Longest baseline that is used, over s. The weight beyond it is neglected, which is 1e-8, or 1e-5 for the
responses."""

MOST_PIXELS = 5000
"""Largest number of pixels of half of the disc, the unknowns of the functional: its matrix takes 0.2 GB then. It allows
for discs of 56 arcsec with baselines of 90 kilowavelengths."""

MOST_SCATTER = 0.25
"""Largest value of 2 pi^2 sigma^2 s^2; from 1/2 on, the weights would no longer fall with the length of the
baseline."""


@dataclass(frozen=True)
class MeasuredMoments:
    """Moments of one galaxy [Jy].

    Parameters
    ----------
    shape
        M_1, M_2.
    response
        Derivatives of M_1, M_2 (first index) with respect to g1, g2 (second index); their noise has mean zero.
    third
        K, the coefficient of third order.
    size
        M_R.
    covariance
        Covariance of M_1, M_2, M_R due to noise.
    """

    shape: Float[Array, " 2"]
    response: Float[Array, "2 2"]
    third: float
    size: float
    covariance: Float[Array, "3 3"]


class MomentFunctional:
    """Weights of the moments on the cells of one facet and beam, which any number of sources share.

    Attributes
    ----------
    radius
        Radius of the disc within which the functional is exact [rad].

    Parameters
    ----------
    uv
        Cells of the facets [wavelengths].
    power
        Power of the beam on these cells.
    width
        Width of the facets [rad].
    position_sigma
        Standard deviation of the errors of the sources' positions, in l and in m [rad].
    """

    def __init__(
        self,
        uv: Float[Array, "cell 2"],
        power: Float[Array, " cell"],
        width: float,
        position_sigma: float = 0.0,
    ) -> None:
        scatter = 2 * (math.pi * position_sigma * SCALE) ** 2
        if scatter >= MOST_SCATTER:
            raise InputError(
                f"--position-error-arcsec {position_sigma / ARCSEC:.2g} (position_sigma=): the estimator moments can"
                f" allow for errors of at most {math.sqrt(MOST_SCATTER / 2) / math.pi / SCALE / ARCSEC:.2g} arcsec"
            )
        longest = REACH * SCALE / math.sqrt(1 - 2 * scatter)
        self._cells = np.flatnonzero(np.hypot(*uv.T) <= longest)
        near, power = uv[self._cells], power[self._cells]
        x, y = near.T / SCALE
        rho, a, b = x * x + y * y, x * x - y * y, 2 * x * y
        # The integrals are over half of the plane, to which half of the cell at the origin belongs.
        area = np.where(rho > 0, 1.0, 0.5) / (width * SCALE) ** 2
        weight = area * np.exp(-rho * (0.5 - scatter))
        third = rho * (rho * (rho * (rho / 16 - 1) + 3.5) - 2)
        targets = weight * np.stack([a, b, a * a - 2 * rho, a * b, b * b - 2 * rho, third, rho])
        # Weights that end before ``longest``, as those of a small array do, need no finer pixels than their own end.
        end = min(longest, float(np.hypot(*near.T).max(initial=0.0)) + 1 / width)
        disc = Disc(width, end, MOST_PIXELS)
        self.radius = disc.radius
        even = EvenPart(disc, near, power)
        self._weights = even.weights(even.values_at_pixels(targets))
        shown = self._weights[[0, 1, 6]]
        self._covariance = (shown * np.abs(power)) @ shown.T

    def size_of(self) -> float:
        """Return the memory that the functional takes [bytes]."""
        return self._weights.nbytes + self._cells.nbytes

    def measure(self, correlation: Complex[Array, " cell"]) -> MeasuredMoments:
        """Return the moments of the data of one facet about its centre."""
        m1, m2, r11, r12, r22, third, size = (
            self._weights @ correlation[self._cells].real
        ).tolist()
        return MeasuredMoments(
            shape=np.array([m1, m2]),
            response=np.array([[r11, r12], [r12, r22]]),
            third=third,
            size=size,
            covariance=self._covariance,
        )
