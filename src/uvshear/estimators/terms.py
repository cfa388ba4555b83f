"""The terms of the two sums whose ratio is the shear."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.geometry.ellipticity import to_field_frame
from uvshear.typing import Array, Bool, Complex, Float, Int


@dataclass(frozen=True)
class Terms:
    r"""Two numbers of each source, and their response to a shear.

    With v_i the numbers and R_i their derivatives with respect to the shear,

    .. math:: g = g_0 + \Big(\sum_i R_i\Big)^{-1} \sum_i v_i,

    g_0 being the shear about which an estimator is expanded.

    Parameters
    ----------
    value
        The numbers v of each source; NaN where they are not known.
    response
        The response R of each source; the last index is that of the component of the shear. It is zero where the source
        does not contribute to the shear.
    """

    value: Float[Array, "source 2"]
    response: Float[Array, "source 2 2"]

    def __len__(self) -> int:
        return len(self.value)

    @property
    def tells(self) -> Bool[Array, " source"]:
        """Mask of the sources that contribute to the shear."""
        is_finite = np.isfinite(self.value).all(axis=1) & np.isfinite(self.response).all(
            axis=(1, 2)
        )
        return is_finite & (self.response != 0).any(axis=(1, 2))

    def select(self, chosen: Bool[Array, " source"] | Int[Array, " chosen"] | slice) -> Self:
        """Return the terms of some of the sources."""
        return type(self)(self.value[chosen], self.response[chosen])

    def weighted(self, weight: Float[Array, " source"]) -> Self:
        """Return the terms multiplied by a weight of each source."""
        return type(self)(weight[:, None] * self.value, weight[:, None, None] * self.response)

    def in_sky_frame(self, local_north: Float[Array, " source"]) -> Self:
        r"""Return terms of the frame of (l, m) in the frame of the sky.

        The components of a shear are transformed by a symmetric matrix T that is its own inverse, so that

        .. math:: v' = T v,\quad R' = T R T,\quad T = \begin{pmatrix} \cos 2\psi & -\sin 2\psi \\
                  -\sin 2\psi & -\cos 2\psi \end{pmatrix}

        Parameters
        ----------
        local_north
            Angle psi of local North at each source [rad].
        """
        cosine, sine = np.cos(2 * local_north), np.sin(2 * local_north)
        # T takes g to conj(g exp(2 i psi)): a turn, and the sign of g2, since East is to the left on the sky.
        turn = np.stack([cosine, -sine, -sine, -cosine], axis=-1).reshape(-1, 2, 2)
        value = np.einsum("sij,sj->si", turn, self.value)
        return type(self)(value, turn @ self.response @ turn)

    @classmethod
    def joined(cls, parts: list[Self]) -> Self:
        """Return the terms of several parts of a sample, one after the other."""
        return cls(
            np.concatenate([np.zeros((0, 2)), *(part.value for part in parts)]),
            np.concatenate([np.zeros((0, 2, 2)), *(part.response for part in parts)]),
        )


def shear_in_field_frame(
    shear: complex, local_north: Float[Array, " source"]
) -> Complex[Array, " source"]:
    """Return the shear at each source in the frame of (l, m) for one that is constant in the frame of the sky."""
    return to_field_frame(np.full(len(local_north), shear), local_north)
