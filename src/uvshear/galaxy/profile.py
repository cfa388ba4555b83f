"""What every brightness profile offers: its Fourier transform as a function of one variable."""

from abc import ABC, abstractmethod

import numpy as np

from uvshear.typing import Array, Float


class Profile(ABC):
    r"""A galaxy with elliptical isophotes, of unit flux.

    Its Fourier transform is real and depends on

    .. math:: q = 4\pi^2 \alpha^2 |A^{-T} k|^2,\quad k = (u, v)

    alone (Rivi & Miller 2018, eq. 1 and 2), so a profile is one function of q. A profile of your own
    defines :meth:`envelope`; any elementwise numpy expression will do.
    """

    @abstractmethod
    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Fourier transform at ``q`` >= 0; 1 at 0, of the dtype of ``q``."""

    def envelope_slope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Return the envelope's derivative with respect to q; central differences unless overridden."""
        step = 1e-4 * (1 + q)
        ahead, behind = q + step, np.maximum(q - step, 0)
        return (self.envelope(ahead) - self.envelope(behind)) / (ahead - behind)
