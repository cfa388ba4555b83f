"""Sums over the cells of a facet from which the Gauss-Newton steps of one galaxy are computed."""

from dataclasses import dataclass

import numpy as np

from uvshear.typing import Array, Float

COUNT = 19
"""Number of sums that ``kernels.normal_sums`` writes."""

_UPPER = np.array([[4, 5, 6, 7], [5, 8, 9, 10], [6, 9, 11, 12], [7, 10, 12, 13]])
"""Positions of the elements of the Gram matrix, whose upper triangle is written by rows."""

_CURVATURE = np.array([[16, 17], [17, 18]])


@dataclass(frozen=True)
class NormalSums:
    """Sums for a template of unit flux at the centre of a correlator, in the correlator's units.

    The responses are those of the visibilities to flux, e1, e2 and ln alpha. They are real, whereas the responses to
    the position are imaginary, so that the two groups decouple.

    Parameters
    ----------
    values
        The sums in the order in which ``kernels.normal_sums`` writes them.
    """

    values: Float[Array, " 19"]

    @property
    def products(self) -> Float[Array, " 4"]:
        """Products of the responses with the data."""
        return self.values[:4]

    @property
    def gram(self) -> Float[Array, "4 4"]:
        """Products of the responses with one another, weighted by the power."""
        return self.values[_UPPER]

    @property
    def norm(self) -> float:
        """<m, m> of the template."""
        return float(self.values[4])

    @property
    def position_gradient(self) -> Float[Array, " 2"]:
        """Derivative of <d, m> with respect to the position."""
        return self.values[14:16]

    @property
    def position_curvature(self) -> Float[Array, "2 2"]:
        """Products of the responses to the position with one another, weighted by the power."""
        return self.values[_CURVATURE]
