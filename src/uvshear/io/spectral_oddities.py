"""Facts about channels and correlations that a user should know, as a reader finds them in a file."""

from typing import Final

import numpy as np

from uvshear.interferometer.spectral_window import Channels
from uvshear.typing import Array, Float

OVERLAP: Final = 0.5
"""Ratio of the spacing of neighbouring channels to their width below which they are said to overlap."""

WIDEST: Final = 4.0
"""Ratio of the band that a channel was averaged over to its width above which one of them is wrong; after Hanning
smoothing it is 2.67."""

WIDEST_GAP: Final = 4.0
"""Ratio of the gap between neighbouring channels to the width of all channels together above which one of their
frequencies may be wrong."""


def spectral_oddities(
    channels: Channels, averaged: Float[Array, " chan"], only_hand: str | None
) -> tuple[str, ...]:
    """Return one sentence for each fact.

    Parameters
    ----------
    channels
        Channels of a spectral window.
    averaged
        Band that each channel was averaged over [Hz].
    only_hand
        Name of the correlation that alone is taken as Stokes I; None where two are, or where it is Stokes I.
    """
    found = []
    if only_hand is not None:
        found.append(f"{only_hand} alone is taken as Stokes I, as there is no other parallel hand")
    order = np.argsort(channels.frequency)
    frequency, width = channels.frequency[order], channels.width[order]
    if np.any(np.diff(frequency) < OVERLAP * np.minimum(width[1:], width[:-1])):
        found.append(
            "channels overlap: the steps between their frequencies are less than half of their widths"
        )
    gap = np.max(np.diff(frequency), initial=0.0)
    if gap > WIDEST_GAP * width.sum():
        found.append(
            f"a gap of {gap / 1e6:.6g} MHz divides channels that are {width.sum() / 1e6:.6g} MHz wide together; one of"
            " their frequencies may be wrong"
        )
    if np.any(averaged > 0) and np.any(averaged == 0):
        found.append(
            "some channels are averages over a band and others are not, by their effective widths"
        )
    if np.any(averaged > WIDEST * channels.width):
        found.append(
            f"channels are averages over more than {WIDEST:g} times their widths, by their effective widths"
        )
    return tuple(found)
