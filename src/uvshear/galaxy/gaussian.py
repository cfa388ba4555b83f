"""The Gaussian profile, whose Fourier transform is a Gaussian too."""

from dataclasses import dataclass

from uvshear.galaxy import kernels
from uvshear.galaxy.profile import Profile
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class Gaussian(Profile):
    r"""Gaussian with brightness proportional to exp(-r^2 / (2 alpha^2)): alpha is sigma of a round galaxy.

    .. math:: f(q) = e^{-q/2},\quad f'(q) = -\tfrac{1}{2} e^{-q/2}

    Notes
    -----
    ``galsim.Gaussian(sigma=alpha/sqrt(1-|e|**2)).shear(g1=e1, g2=e2)`` is the same galaxy. Lensing at unit
    magnification acts on it as on :class:`~uvshear.galaxy.exponential.Exponential`.
    """

    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Fourier transform at ``q`` >= 0."""
        return kernels.gaussian_envelope(q.ravel()).reshape(q.shape)

    @property
    def extent(self) -> float:
        """Distance beyond which a millionth of the flux lies: exp(-r^2/2) = 1e-6 [sigma]."""
        return 5.26

    def envelope_slope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Differentiate the envelope with respect to q."""
        return kernels.gaussian_slope(q.ravel()).reshape(q.shape)
