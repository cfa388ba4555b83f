"""Image sizes that a fast Fourier transform handles quickly."""

import math

from scipy import fft


def fast_size(least: float, *, multiple: int = 2, real: bool = True) -> int:
    """Smallest multiple of ``multiple``, at least ``least``, that has only small prime factors.

    Parameters
    ----------
    least
        Lower bound of the size [pixels].
    multiple
        Divisor that the size must have: two where an image has a central pixel, four where the same image is also
        transformed on pixels twice as wide.
    real
        Whether the transform is of real numbers, for which the library has factors up to 5; complex ones have up to 11.
    """
    size = math.ceil(least / multiple) * multiple
    while fft.next_fast_len(size, real=real) != size:
        size += multiple
    return size
