"""The channels of an observation."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class Channels:
    """Frequency channels of one spectral window.

    Parameters
    ----------
    frequency
        Channel centres [Hz].
    width
        Channel widths [Hz], positive.
    """

    frequency: Float[Array, " chan"]
    width: Float[Array, " chan"]

    def __post_init__(self) -> None:
        if not np.all((self.frequency > 0) & np.isfinite(self.frequency)):
            raise InputError("a channel's frequency is not positive; frequencies are in Hz")
        if not np.all((self.width > 0) & np.isfinite(self.width)):
            raise InputError("a channel's width is not positive; widths are in Hz")

    def __len__(self) -> int:
        return len(self.frequency)

    @classmethod
    def from_band(cls, low: float, high: float, count: int) -> Self:
        """Divide the band from ``low`` to ``high`` [Hz] into equal channels."""
        if not 0 < low < high:
            raise InputError(f"the band {low:g} to {high:g} Hz is empty; it needs 0 < low < high")
        if count < 1:
            raise InputError(f"{count} channels; one or more are needed")
        width = (high - low) / count
        return cls(frequency=low + width * (np.arange(count) + 0.5), width=np.full(count, width))
