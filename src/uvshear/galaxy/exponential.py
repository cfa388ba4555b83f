"""The exponential disc, the profile of a star-forming galaxy."""

from dataclasses import dataclass

from uvshear.galaxy import kernels
from uvshear.galaxy.profile import Profile
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class Exponential(Profile):
    r"""Disc with brightness proportional to exp(-r/alpha).

    .. math:: f(q) = (1 + q)^{-3/2},\quad f'(q) = -\tfrac{3}{2} (1 + q)^{-5/2}

    References
    ----------
    Rivi & Miller 2018, eq. 1.

    Notes
    -----
    ``galsim.Exponential(scale_radius=alpha/sqrt(1-|e|**2)).shear(g1=e1, g2=e2)`` is the same galaxy: alpha is not the
    area-preserving radius, 1.678 times which holds half of the light. Lensing acts through ``add_shear`` and
    ``sheared_scale_length`` at unit magnification, like ``shear`` of GalSim; a magnification mu also multiplies alpha
    by sqrt(mu) and the flux by mu.
    """

    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Fourier transform at ``q`` >= 0."""
        return kernels.exponential_envelope(q.ravel()).reshape(q.shape)

    @property
    def extent(self) -> float:
        """Distance beyond which a millionth of the flux lies: (1 + r) exp(-r) = 1e-6 [scale lengths]."""
        return 16.7

    def envelope_slope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Differentiate the envelope with respect to q."""
        return kernels.exponential_slope(q.ravel()).reshape(q.shape)
