r"""Coordinates that are turned to another phase centre, in which a part of the sky is nearly flat.

With s = (l, m, n) a direction, b a baseline and z = (0, 0, 1), the phase is b . (s - z) turns. A rotation R that takes
the new centre c to z changes no scalar product, so that

.. math:: b \cdot (s - z) = (R b) \cdot (R s - z) + b \cdot (c - z).
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.geometry.directions import n_minus_one, n_minus_one_at
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class TangentFrame:
    """Frame of directions and baselines about a centre; the transformations are exact.

    Parameters
    ----------
    offset
        Direction of the centre from the phase centre, (l, m, n - 1).
    rotation
        Matrix that takes the centre to (0, 0, 1).
    """

    offset: Float[Array, " 3"]
    rotation: Float[Array, "3 3"]

    @classmethod
    def at(cls, l: float, m: float) -> Self:
        """Frame about the direction (l, m), by the shortest rotation."""
        n1 = n_minus_one_at(l, m)
        cross = np.array([[0, 0, -l], [0, 0, -m], [l, m, 0]])
        return cls(np.array([l, m, n1]), np.eye(3) + cross + cross @ cross / (2 + n1))

    def baselines(self, uvw: Float[Array, "sample 3"]) -> Float[Array, "sample 3"]:
        """Baselines in this frame, in the unit of those given."""
        return uvw @ self.rotation.T

    def turns(self, uvw: Float[Array, "sample 3"]) -> Float[Array, " sample"]:
        """Phase of the centre [turns], for baselines in wavelengths."""
        return uvw @ self.offset

    def directions(
        self, l: Float[Array, " source"], m: Float[Array, " source"]
    ) -> tuple[Float[Array, " source"], Float[Array, " source"]]:
        """Direction cosines in this frame."""
        turned = self.rotation[:2] @ np.stack([l, m, 1 + n_minus_one(l, m)])
        return turned[0], turned[1]

    def forms(
        self,
        l: Float[Array, " source"],
        m: Float[Array, " source"],
        forms: Float[Array, "source 3"],
    ) -> Float[Array, "source 3"]:
        """Quadratic forms of galaxies (``ellipticity.quadratic_form``) in this frame.

        (u, v) is the gradient of the phase with respect to (l, m). With J the Jacobian of the new direction cosines
        with respect to the old ones, a form with the matrix F becomes J F J^T.
        """
        n = 1 + n_minus_one(l, m)
        by_l = self.rotation[:2, 0, None] - self.rotation[:2, 2, None] * (l / n)
        by_m = self.rotation[:2, 1, None] - self.rotation[:2, 2, None] * (m / n)
        derivative = np.stack([by_l, by_m], axis=1)
        a, half, c = forms[:, 0], forms[:, 1] / 2, forms[:, 2]
        turned = np.einsum(
            "ijs,jks,lks->sil", derivative, np.array([[a, half], [half, c]]), derivative
        )
        return np.stack([turned[:, 0, 0], 2 * turned[:, 0, 1], turned[:, 1, 1]], axis=-1)
