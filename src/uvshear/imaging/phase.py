"""Visibilities as seen from a source, with the phase centre moved to it."""

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.geometry.directions import n_minus_one_at
from uvshear.imaging.kernels import rotate_phase
from uvshear.typing import Array, Complex, Float


def shift_phase_centre(
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    vis: Complex[Array, "row chan"],
    l: float,
    m: float,
) -> Complex[Array, "row chan"]:
    """Multiply by exp(-2 pi i (u l + v m + w (n-1))), which moves the phase centre to (l, m).

    Parameters
    ----------
    uvw
        Baselines [m].
    frequency
        Channel centres [Hz].
    vis
        Visibilities; the result has their dtype.
    l, m
        Direction cosines of the new phase centre.
    """
    n1 = n_minus_one_at(l, m)
    columns = np.ascontiguousarray(uvw.T, float)
    shifted = np.empty_like(vis)
    for chan, per_metre in enumerate(frequency / SPEED_OF_LIGHT):
        rotated = np.empty(len(vis), vis.dtype)
        rotate_phase(columns, per_metre, (l, m, n1), np.ascontiguousarray(vis[:, chan]), rotated)
        shifted[:, chan] = rotated
    return shifted


def baselines_seen_from(uvw: Float[Array, "row 3"], l: float, m: float) -> Float[Array, "row 3"]:
    r"""Baselines of the plane tangent at (l, m): u - w l/n, v - w m/n, w.

    With x the distance from (l, m) in direction cosines, w (n - 1) = w (n_s - 1) - w (l x_l + m x_m)/n_s
    - w x^2/2 + ...: the second term is a shift of (u, v), which is 1 per cent at half a degree for SKA-Mid.
    """
    n = 1 + n_minus_one_at(l, m)
    return np.column_stack(
        [uvw[:, 0] - uvw[:, 2] * (l / n), uvw[:, 1] - uvw[:, 2] * (m / n), uvw[:, 2]]
    )
