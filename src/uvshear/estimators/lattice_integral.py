"""The integral over ellipticities as a sum over the nodes of the likelihood's own lattice, behind which g moves p."""

import numpy as np

from uvshear.estimators.shape_integral import ShapeIntegral, WeightedLattice
from uvshear.galaxy import EllipticityPrior
from uvshear.typing import Array, Complex, Float

CLEARANCE = 5.0
"""Standard deviations that a likelihood keeps from e = 0 and from the largest modulus, where p is not smooth.

Its lattice ends at four."""


class LatticeIntegral(ShapeIntegral):
    """Sum over the lattice, for a likelihood within which p is smooth.

    The trapezoidal rule with steps of 0.9 standard deviations integrates a Gaussian to 1e-10. Nothing is interpolated,
    and the derivatives by g are those of p: they do not grow with the signal-to-noise ratio as do those of a likelihood
    of width sigma, whose second derivatives turn an error of 1e-4 into one of 1e-4/sigma^2.
    """

    def __init__(self, lattice: WeightedLattice) -> None:
        self.about = lattice.about
        self._e = lattice.likelihood.ellipticity
        area = abs(np.linalg.det(lattice.likelihood.axes[:2, :2]))
        value, slope, bend = (area * part for part in lattice.parts)
        self._parts = value, slope, bend

    def lensed(self, g: complex) -> Complex[Array, " node"]:
        """Return e, which is that of the lattice whatever the shear."""
        del g
        return self._e

    def parts(
        self, g: complex
    ) -> tuple[Float[Array, " node"], Float[Array, " node"], Float[Array, " node"]]:
        """Return f and its derivatives at the nodes of the lattice."""
        del g
        return self._parts

    def weight(self, prior: EllipticityPrior, g: complex) -> Float[Array, " node"]:
        """Return p(e_s) r^2."""
        to_unlensed = 1 - np.conj(g) * self._e
        modulus = np.abs((self._e - g) / to_unlensed)
        area = ((1 - abs(g) ** 2) / np.abs(to_unlensed) ** 2) ** 2
        return prior.modulus_density(modulus) / (2 * np.pi * modulus) * area


def is_clear(lattice: WeightedLattice, maximum: float) -> bool:
    """Tell whether the likelihood keeps clear of the places where p is not smooth."""
    middle, reach = abs(lattice.unlensed_mean), CLEARANCE * lattice.extremes[1]
    return reach < middle < maximum - reach
