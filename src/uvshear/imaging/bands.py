"""Bands of baseline lengths: short baselines need few pixels, and most baselines are short.

Four in five baselines of SKA-Mid are shorter than a fifth of the longest that carries information on galaxies. Each
band is imaged on pixels of its own, which are twice as wide as those of the next longer band.
"""

from dataclasses import dataclass

from uvshear.typing import Array, Bool, Float

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
