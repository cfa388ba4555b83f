"""The likelihood of one galaxy's shape on a lattice of ellipticities and sizes."""

from dataclasses import dataclass

from uvshear.typing import Array, Complex, Float, Int


@dataclass(frozen=True)
class ShapeLikelihood:
    """Likelihood of one galaxy on a lattice over (e, ln alpha), marginalised over position and flux.

    Parameters
    ----------
    point
        Integer coordinates of the nodes of the lattice.
    origin, axes
        The nodes are ``origin + axes @ point`` in (e1, e2, ln(alpha/rad)); the last axis is along ln alpha.
    log_likelihood
        Log likelihood at each node, up to a constant.
    flux, flux_variance
        Mean and variance of the flux at each node [Jy].
    """

    point: Int[Array, "node 3"]
    origin: Float[Array, " 3"]
    axes: Float[Array, "3 3"]
    log_likelihood: Float[Array, " node"]
    flux: Float[Array, " node"]
    flux_variance: Float[Array, " node"]

    @property
    def ellipticity(self) -> Complex[Array, " node"]:
        """Ellipticity at each node."""
        first, second = (self.origin[:2] + self.point @ self.axes[:2].T).T
        return first + 1j * second

    @property
    def log_scale_length(self) -> Float[Array, " node"]:
        """Natural logarithm of the scale length in radians at each node."""
        return self.origin[2] + self.point @ self.axes[2]
