"""A brightness profile of one's own: a core and a halo, both Gaussians."""

from dataclasses import dataclass

import numpy as np

from uvshear import Profile


@dataclass(frozen=True)
class DoubleGaussian(Profile):
    """Gaussian of the scale length, with a part of the flux in one that is twice as wide."""

    halo: float = 0.4

    def envelope(self, q):
        """Fourier transform at ``q``."""
        return (1 - self.halo) * np.exp(-q / 2) + self.halo * np.exp(-2 * q)
