r"""Moments of a galaxy's visibility function: no profile, no prior, linear in the data but for the centre.

With V the galaxy's visibility function about its own centre, rho = u^2 + v^2, a = u^2 - v^2, b = 2 u v and
f = exp(-rho/2 s^2), everything over s,

.. math::
    M_1 = \int a f V,\quad M_2 = \int b f V,\quad M_R = \int \rho f V

over half of the uv plane. A shear g maps V(k) to V((1 + G) k), G = ((g1, g2), (g2, -g1)), to first order; by parts

.. math::
    \frac{\partial M_1}{\partial g_1} = -\int (2 \rho - a^2) f V,\quad
    \frac{\partial M_1}{\partial g_2} = \frac{\partial M_2}{\partial g_1} = \int a b f V,\quad
    \frac{\partial M_2}{\partial g_2} = -\int (2 \rho - b^2) f V.

These are weighted sums of the data too, and linear: sum M over sum R is a shear without noise bias, whatever the
profile (moments with a weight in Fourier space are those of Bernstein & Armstrong 2014 and Bernstein et al. 2016).

**Gaps.** V is not measured everywhere: between the tracks of a few baselines the beam's power is next to nothing. But a
galaxy is small, so that V is smooth, and a sum over measured cells with the right weights is the integral: the sum
b(x) over a disc whose convolution with the beam is the transform of the moment's weight all over the disc, and then M
of anything inside. It is the linear estimate of least noise among those.

**The centre.** About a wrong centre x the moments are smaller by 2 pi^2 (k.x)^2. The centre here is where the first
moments with the weight P exp(-rho/2 s_x^2) vanish, which the data's own noise displaces; what that changes on average
is known to second order in the noise, and taken away. With A = dX/dx, C the covariance of X, and M_ab second
derivatives,

.. math::
    E[M(\hat x)] = M + \mathrm{tr}(A^{-1} K) + \tfrac12 \mathrm{tr}(M'' A^{-1} C A^{-1}),\quad
    K_{ab} = \mathrm{cov}(X_b, \partial_a M).
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from uvshear.typing import Array, Complex, Float

SCALE = 15e3
"""s [wavelengths]. Larger weights have more noise for galaxies of an arcsecond, smaller ones too."""

CENTRE_SCALE = 2.0
"""s_x over s."""

FURTHEST = 0.5
"""Most that the centre may move, over 1/(2 pi s): 1.1 arcsec for 15 000 wavelengths."""

REACH = 4.5
"""Longest baseline that takes part, over s."""

DISC = 0.3
"""Radius of the disc over the facet's width: 13 scale lengths."""

_OVERSAMPLING = 1.15
_RIDGE = 1e-8
"""Part of the beam's power that is added to make up for rounding."""

_STEPS = 20
_CLOSE = 1e-6
_TARGETS = 6


@dataclass(frozen=True)
class Moments:
    """Moments [Jy], free of what the noise does by way of the centre.

    Parameters
    ----------
    shape
        M_1, M_2.
    response
        Their derivatives by g1, g2 (the second index), which include the noise's own, of mean zero.
    size
        M_R.
    covariance
        Of M_1, M_2, M_R by noise, the centre held.
    offset
        Centre, from the facet's [rad].
    """

    shape: Float[Array, " 2"]
    response: Float[Array, "2 2"]
    size: float
    covariance: Float[Array, "3 3"]
    offset: Float[Array, " 2"]


class MomentFunctional:
    """The moments' weights on the cells of one facet and beam; any number of sources share it."""

    def __init__(
        self,
        uv: Float[Array, "cell 2"],
        power: Float[Array, " cell"],
        width: float,
        scale: float = SCALE,
    ) -> None:
        """For a facet ``width`` wide [rad], whose cells count for their opposites as well."""
        self.scale = scale
        self._cells = np.flatnonzero(np.hypot(*uv.T) <= REACH * scale)
        near, power = uv[self._cells], power[self._cells]
        x, y = near.T / scale
        rho, a, b = x * x + y * y, x * x - y * y, 2 * x * y
        # The integral over half of the plane; the cell at the origin stands for itself alone.
        area = np.where(rho > 0, 1.0, 0.5) / (width * scale) ** 2
        weight = area * np.exp(-rho / 2)
        targets = weight * np.stack(
            [a, b, a * a - 2 * rho, a * b, b * b - 2 * rho, rho]
        )
        on_data = _weights_of_least_noise(near, power, targets, width, REACH * scale)
        seconds = np.stack([x * x, x * y, y * y])
        centre = np.exp(-rho / 2 / CENTRE_SCALE**2)
        # Positions count in 1/(2 pi s): a displacement of one turns the phase by x.
        self._x, self._y = x, y
        self._first = np.stack([x, y]) * centre
        self._slope = seconds * centre
        self._values = np.concatenate([on_data, *(-on_data * second for second in seconds)])
        self._of_centre = seconds @ (centre**2 * power)
        self._of_both = np.array([on_data @ (second * centre * power) for second in seconds])
        chosen = on_data[[0, 1, 5]]
        self._covariance = (chosen * power) @ chosen.T

    def measure(self, correlation: Complex[Array, " cell"]) -> Moments | None:
        """Moments about the centre found; None where none is found."""
        found = self._find_centre(correlation[self._cells])
        if found is None:
            return None
        position, real, inverse = found
        values = self._values @ real
        moments, seconds = values[:_TARGETS], values[_TARGETS:].reshape(3, _TARGETS)
        noise = inverse @ _symmetric(self._of_centre) @ inverse
        # tr(S T) of symmetric matrices from their three numbers
        moments = moments - _trace(inverse, self._of_both) - 0.5 * _trace(noise, seconds)
        m1, m2, r11, r12, r22, size = moments.tolist()
        return Moments(
            shape=np.array([m1, m2]),
            response=np.array([[r11, r12], [r12, r22]]),
            size=size,
            covariance=self._covariance,
            offset=position / (2 * math.pi * self.scale),
        )

    def _find_centre(
        self, correlation: Complex[Array, " cell"]
    ) -> tuple[Float[Array, " 2"], Float[Array, " cell"], Float[Array, "2 2"]] | None:
        """Centre, the real part about it, and the inverse of dX/dx; by Newton's method from the facet's centre."""
        position = np.zeros(2)
        for _ in range(_STEPS):
            centred = correlation * np.exp(-1j * (position[0] * self._x + position[1] * self._y))
            slope = _symmetric(self._slope @ centred.real)
            if not (slope[0, 0] > 0 and np.linalg.det(slope) > 0):
                return None
            inverse = np.linalg.inv(slope)
            step = inverse @ (self._first @ centred.imag)
            if float(np.hypot(*step)) < _CLOSE:
                return position, centred.real, inverse
            position = position + step / max(1.0, float(np.hypot(*step)) / FURTHEST)
            if np.hypot(*position) > 2 * FURTHEST:
                return None
        return None


def _weights_of_least_noise(
    uv: Float[Array, "cell 2"],
    power: Float[Array, " cell"],
    targets: Float[Array, "target cell"],
    width: float,
    longest: float,
) -> Float[Array, "target cell"]:
    """Weights on data of a galaxy within the disc that sum to what the targets on its V would.

    Of even targets; the real part of the data is meant. ``longest`` is the longest of the cells' baselines.
    """
    size = math.ceil(width * 2 * longest * _OVERSAMPLING)
    x = (np.arange(size) - size // 2) * (width / size)
    places = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    places = places[np.hypot(*places.T) < DISC * width]
    phase = 2 * math.pi * places @ uv.T
    cosine, sine = np.cos(phase), np.sin(phase)
    relative = power / power.max()
    beam = (cosine * relative) @ cosine.T + (sine * relative) @ sine.T
    beam[np.diag_indices_from(beam)] *= 1 + _RIDGE
    solution = cho_solve(cho_factor(beam, overwrite_a=True), cosine @ targets.T)
    return (cosine.T @ solution).T / power.max()


def _symmetric(three: Float[Array, " 3"]) -> Float[Array, "2 2"]:
    return np.array([[three[0], three[1]], [three[1], three[2]]])


def _trace(
    matrix: Float[Array, "2 2"], three: Float[Array, "3 target"]
) -> Float[Array, " target"]:
    return matrix[0, 0] * three[0] + 2 * matrix[0, 1] * three[1] + matrix[1, 1] * three[2]
