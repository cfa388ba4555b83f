"""Bands of baseline lengths: short baselines need few pixels, and most baselines are short.

Four in five baselines of SKA-Mid are shorter than a fifth of the longest that carries information on galaxies. Each
band is imaged on pixels of its own, which are twice as wide as those of the next longer band.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uvshear.imaging.curvature import LEAST_N
from uvshear.typing import Array, Bool, Float, Int

OVERSAMPLING = 1.2
"""Nyquist frequency of the finest pixels over the longest baseline."""

COARSE_FRACTION = 0.75
"""Longest baseline of a coarser band over the one that the same oversampling would allow. Its pixels then oversample
1.6 times, which interpolation to finer pixels requires."""

MOST_BANDS = 4
"""Largest number of bands."""

FEWEST_PIXELS = 512
"""Smallest image of the whole field for which a band is worthwhile; a band with a smaller one joins the next longer
band."""


@dataclass(frozen=True)
class Band:
    """Range of baseline lengths, and the pixels on which these baselines are imaged.

    Parameters
    ----------
    shortest, longest
        Limits of the baseline length [wavelengths].
    pixel
        Width of a pixel [rad].
    """

    shortest: float
    longest: float
    pixel: float

    def holds(self, distance: Float[Array, " sample"]) -> Bool[Array, " sample"]:
        """Whether baselines of these lengths [wavelengths] are in the band."""
        return (distance >= self.shortest) & (distance < self.longest)


def steepest(l: Float[Array, " source"], m: Float[Array, " source"]) -> float:
    """Largest slope of n among directions, sqrt(l^2 + m^2)/n; 0 without a direction."""
    r2 = np.minimum(l**2 + m**2, 1 - LEAST_N**2)
    return float(np.sqrt(r2 / (1 - r2)).max(initial=0.0))


def longest_seen(uvw: Float[Array, "sample 3"], slope: float) -> Float[Array, " sample"]:
    """Greatest length of (u - w l/n, v - w m/n) over the directions up to a slope sqrt(l^2 + m^2)/n [wavelengths].

    Pixels must represent the baselines as the sources see them, which differ from those that the phase centre sees.
    """
    return np.hypot(uvw[:, 0], uvw[:, 1]) + slope * np.abs(uvw[:, 2])


def octaves(shortest: float, longest: float, width: float) -> tuple[Band, ...]:
    """Divide baselines into bands, from the longest down.

    The pixel of band b is 2^b times that of band 0, so that all images lie on one lattice.

    Parameters
    ----------
    shortest, longest
        Limits of the baseline length [wavelengths].
    width
        Width of the field [rad].
    """
    pixel = 1 / (2 * OVERSAMPLING * longest)
    bands = 1
    while (
        bands < MOST_BANDS
        and width / (pixel * 2**bands) >= FEWEST_PIXELS
        and COARSE_FRACTION * longest / 2**bands > shortest
    ):
        bands += 1
    edges = [longest, *(COARSE_FRACTION * longest / 2**band for band in range(1, bands)), shortest]
    return tuple(Band(edges[b + 1], edges[b], pixel * 2**b) for b in range(bands))


def numbers_of_bands(
    bands: Sequence[Band], distance: Float[Array, " sample"]
) -> Int[Array, " sample"]:
    """Return the number of the band of each length [wavelengths]; the first and the last have no outer limit."""
    edges = [band.shortest for band in bands[:-1]][::-1]
    return len(edges) - np.searchsorted(edges, distance, side="right")
