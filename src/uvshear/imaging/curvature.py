r"""Curvature of n over a tile: what the plane tangent at its centre leaves out limits its width.

Within a tile, n is expanded about the tile's centre at the distance r from the phase centre. With x the distance from
there along the radius and y across it,

.. math:: n(x, y) = n - \frac{r x}{n} - \frac{x^2}{2 n^3} - \frac{y^2}{2 n} - \frac{r x^3}{2 n^5} + \dots

The gridder's images are round: their second order is (x^2 + y^2)/2, which is multiplied by the mean of the two
curvatures. The phase error is then 2 pi w [(1/n^3 - 1/n) (x^2 - y^2)/4 + r x^3/(2 n^5)].
"""

import math

import numpy as np

from uvshear.typing import Array, Float, Int

LEAST_N = 1e-3
"""Smallest n at which a plane is tangent, 0.06 degrees above the horizon; the centre of a tile may be beyond."""

TOLERANCE = 3e-3
"""Largest phase error at the edge of a tile [rad], for a baseline whose w is the root mean square of its band. The
visibilities of sources within 5 degrees of the phase centre of SKA-Mid, MeerKAT or the VLA are then predicted with
relative errors of 1e-3; without a limit, of 0.05 to 0.11. The tiles of a field of 1 degree are as without one."""


def touching_point(l: float, m: float) -> tuple[float, float, float]:
    """Return the direction (l, m, n) at which the plane of a tile touches the sphere.

    That is the tile's centre, or the nearest direction above the horizon.
    """
    radius, outermost = math.hypot(l, m), math.sqrt(1 - LEAST_N**2)
    if radius > outermost:
        return l * outermost / radius, m * outermost / radius, LEAST_N
    return l, m, math.sqrt(1 - radius**2)


def mean_curvature(n: float) -> float:
    """Mean of the curvatures of n along the radius and across it, (1/n^3 + 1/n)/2; 1 at the phase centre."""
    return (1 / n**3 + 1 / n) / 2


def half_width_within(radius: float, w: float) -> float:
    """Half of the width of a tile in which the phase is within the tolerance; infinite at the phase centre.

    Parameters
    ----------
    radius
        Distance of the tile from the phase centre, as a sine.
    w
        Root mean square of w [wavelengths].
    """
    _, _, n = touching_point(radius, 0.0)
    second = (1 / n**3 - 1 / n) / 4
    third = radius / (2 * n**5)
    if second * w == 0:
        return math.inf
    phase = TOLERANCE / (2 * math.pi * w) / 2
    return min(math.sqrt(phase / second), (phase / third) ** (1 / 3))


def half_widths_of_bands(
    uvw: Float[Array, "sample 3"], band: Int[Array, " sample"], bands: int, radius: float
) -> tuple[float, ...]:
    """Half of the width that a tile may have in each band.

    Parameters
    ----------
    uvw
        Some of the baselines [wavelengths].
    band
        Number of the band of each.
    bands
        Number of bands.
    radius
        Distance of the farthest source from the phase centre, as a sine.
    """
    count = np.maximum(np.bincount(band, minlength=bands), 1)
    w = np.sqrt(np.bincount(band, uvw[:, 2] ** 2, bands) / count)
    return tuple(half_width_within(radius, rms) for rms in w.tolist())
