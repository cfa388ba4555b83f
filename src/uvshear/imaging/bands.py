"""Baselines sorted by length: short ones need few pixels, and most are short.

Four in five baselines of SKA-Mid are below a fifth of the longest that tells anything of a galaxy. Each band
of lengths is imaged with pixels of its own, each twice as wide as those of the band above.
"""

from dataclasses import dataclass

from uvshear.typing import Array, Bool, Float

OVERSAMPLING = 1.2
"""Nyquist frequency of the finest pixels over the longest baseline."""

SHARE = 0.75
"""Longest baseline of a coarser band over what the same oversampling would allow: its pixels oversample 1.6 times,
which is what interpolation to finer pixels needs."""

MOST_BANDS = 4
FEWEST_PIXELS = 512
"""A band whose image of the whole field would be smaller than this joins the one above it."""


@dataclass(frozen=True)
class Band:
    """Baselines from ``shortest`` to ``longest`` [wavelengths], imaged on pixels of ``pixel`` [rad]."""

    shortest: float
    longest: float
    pixel: float

    def holds(self, distance: Float[Array, " sample"]) -> Bool[Array, " sample"]:
        """Whether uv distances [wavelengths] are in the band."""
        return (distance >= self.shortest) & (distance < self.longest)


def octaves(shortest: float, longest: float, width: float) -> tuple[Band, ...]:
    """Bands from the longest baselines down, for a field ``width`` wide [rad].

    The pixel of band b is 2^b times that of band 0, so that all images lie on one lattice.
    """
    pixel = 1 / (2 * OVERSAMPLING * longest)
    bands = 1
    while (
        bands < MOST_BANDS
        and width / (pixel * 2**bands) >= FEWEST_PIXELS
        and SHARE * longest / 2**bands > shortest
    ):
        bands += 1
    edges = [longest, *(SHARE * longest / 2**band for band in range(1, bands)), shortest]
    return tuple(Band(edges[b + 1], edges[b], pixel * 2**b) for b in range(bands))
