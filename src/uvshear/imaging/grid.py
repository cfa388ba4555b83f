"""The pixels of an image."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ImageGrid:
    """Pixels of a square image, with ``image[i, j]`` at l = l0 + (i - size/2) pixel, m = m0 + (j - size/2) pixel.

    Parameters
    ----------
    size
        Number of pixels along a side.
    pixel
        Width of a pixel [rad].
    l0, m0
        Direction cosines of the central pixel.
    """

    size: int
    pixel: float
    l0: float = 0.0
    m0: float = 0.0
