"""Base class of brightness profiles: a Fourier transform as a function of one variable."""

import math
from abc import ABC, abstractmethod

import numpy as np

from uvshear.typing import Array, Float


class Profile(ABC):
    r"""Brightness profile of a galaxy of unit flux with elliptical isophotes.

    Its Fourier transform is real and depends on

    .. math:: q = 4\pi^2 \alpha^2 |A^{-T} k|^2,\quad k = (u, v)

    alone (Rivi & Miller 2018, eq. 1 and 2), so that a profile is a function of q. A subclass defines :meth:`envelope`,
    for which any elementwise numpy expression will do.
    """

    @abstractmethod
    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Fourier transform at ``q`` >= 0, in the dtype of ``q``; its value at 0 is 1."""

    @property
    def extent(self) -> float:
        """Distance beyond which a millionth of the flux lies [scale lengths along an axis]; infinite if not known."""
        return math.inf

    def envelope_slope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Differentiate the envelope with respect to q, by central differences unless a subclass overrides this."""
        step = 1e-4 * (1 + q)
        ahead, behind = q + step, np.maximum(q - step, 0)
        return (self.envelope(ahead) - self.envelope(behind)) / (ahead - behind)
