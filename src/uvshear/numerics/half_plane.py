"""Cells of half of the uv plane: the transform of a real image is Hermitian, and the other half repeats them."""

from dataclasses import dataclass

import numpy as np
from scipy import fft

from uvshear.typing import Array, Float, Int


@dataclass(frozen=True)
class HalfPlane:
    """Cells of half of the uv plane: exactly one of every pair +-k.

    Parameters
    ----------
    index
        Positions of the cells, row and column, in the array that ``rfft2`` returns.
    uv
        Centres of the cells [wavelengths].
    multiplicity
        Number of cells of the whole plane that each stands for: two, and one for the cell at the origin.
    """

    index: tuple[Int[Array, " cell"], Int[Array, " cell"]]
    uv: Float[Array, "cell 2"]
    multiplicity: Float[Array, " cell"]


def half_plane(size: int, pixel: float, shortest: float, longest: float) -> HalfPlane:
    """Cells between two distances from the origin.

    Parameters
    ----------
    size
        Number of pixels along a side of the image.
    pixel
        Width of a pixel [rad].
    shortest, longest
        Limits of the distance, both included [wavelengths].
    """
    u, v = fft.fftfreq(size, pixel), fft.rfftfreq(size, pixel)
    distance = np.hypot(u[:, None], v[None, :])
    # The pairs (u, 0) and (-u, 0) are both in what rfft2 returns.
    is_first_of_pair = (v[None, :] > 0) | (u[:, None] >= 0)
    i, j = np.nonzero((distance >= shortest) & (distance <= longest) & is_first_of_pair)
    multiplicity = np.where(distance[i, j] == 0, 1.0, 2.0)
    # Kernels take one coordinate of many cells at a time.
    return HalfPlane((i, j), np.asfortranarray(np.column_stack([u[i], v[j]])), multiplicity)
