"""Means of an image over rings about its centre."""

import numpy as np

from uvshear.typing import Array, Float


def ring_means(
    image: Float[Array, "l m"], pixel: float
) -> tuple[Float[Array, " ring"], Float[Array, " ring"]]:
    """Return the mean distance from the centre and the mean of each ring that lies in an image.

    Rings are one pixel wide; the first one is the central pixel.

    Parameters
    ----------
    image
        Centred: ``image[i, j]`` at l = (i - size/2) pixel, m = (j - size/2) pixel.
    pixel
        Width of a pixel [rad].

    Returns
    -------
    Array
        Distances [rad].
    Array
        Means, in the unit of the image.
    """
    offset = np.arange(len(image)) - len(image) // 2
    distance = np.hypot(offset[:, None], offset[None, :]).ravel()
    ring = np.rint(distance).astype(int)
    sums = [np.bincount(ring, values)[: len(image) // 2] for values in (distance, image.ravel())]
    count = np.bincount(ring)[: len(image) // 2]
    return sums[0] / count * pixel, sums[1] / count
