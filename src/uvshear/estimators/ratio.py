"""Shear as a ratio of sums: what every estimator here comes to.

Each galaxy gives a pair of numbers and their response to a shear, a 2 x 2 matrix: the weighted ellipticity and the
weight; moments and their derivatives; gradient and curvature of log P(D|g). The shear is the sum of the first over the
sum of the second.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.errors import InputError
from uvshear.estimators.mean import ShearEstimate
from uvshear.typing import Array, Bool, Float

BLOCKS = 100
"""Of the jackknife."""


@dataclass(frozen=True)
class Responses:
    """Numbers of each galaxy (or sums of several) and their response to g1, g2 (the last index).

    ``about`` is the shear at which the estimator is expanded; the ratio counts from there.
    """

    value: Float[Array, "source 2"]
    response: Float[Array, "source 2 2"]
    about: complex = 0j

    def select(self, chosen: Bool[Array, " source"]) -> Self:
        """Return those of some galaxies."""
        return type(self)(self.value[chosen], self.response[chosen], self.about)

    def weighted(self, weight: Float[Array, " source"]) -> Self:
        """Return the same, each galaxy counted by a weight."""
        return type(self)(
            weight[:, None] * self.value, weight[:, None, None] * self.response, self.about
        )

    def shear(self, estimator: str, blocks: int = BLOCKS) -> ShearEstimate:
        """Ratio of the sums; its error by a jackknife of so many blocks of galaxies in turn."""
        count = len(self.value)
        if count < 2:
            raise InputError(f"the shear of {count} galaxies; two or more with weight are needed")
        block = np.arange(count) % min(blocks, count)
        value = np.stack([np.bincount(block, self.value[:, i]) for i in (0, 1)], axis=-1)
        response = np.stack(
            [np.bincount(block, self.response[:, i, j]) for i in (0, 1) for j in (0, 1)], axis=-1
        ).reshape(-1, 2, 2)
        g, error = jackknife(value, response)
        g = g + np.array([self.about.real, self.about.imag])
        return ShearEstimate(
            float(g[0]), float(error[0]), float(g[1]), float(error[1]), count, estimator
        )


def jackknife(
    value: Float[Array, "block 2"], response: Float[Array, "block 2 2"]
) -> tuple[Float[Array, " 2"], Float[Array, " 2"]]:
    """Ratio of sums, and its error from leaving out each block once."""
    total, slope = value.sum(axis=0), response.sum(axis=0)
    left = np.linalg.solve(slope - response, (total - value)[..., None])[..., 0]
    return np.linalg.solve(slope, total), jackknife_error(left)


def jackknife_error(left: Float[Array, "block n"]) -> Float[Array, " n"]:
    """Take the standard error from the estimates without each block in turn."""
    count = len(left)
    error: Float[Array, " n"] = np.sqrt(
        (count - 1) / count * np.sum((left - left.mean(axis=0)) ** 2, axis=0)
    )
    return error
