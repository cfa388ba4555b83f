"""The pixels of an image."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ImageGrid:
    """Square image, ``image[i, j]`` at l = l0 + (i - size/2) pixel, m = m0 + (j - size/2) pixel [rad]."""

    size: int
    pixel: float
    l0: float = 0.0
    m0: float = 0.0
