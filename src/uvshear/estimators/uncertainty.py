"""Standard errors of a ratio of sums, from the scatter of its terms."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from uvshear.estimators.terms import Terms
from uvshear.typing import Array, Float


class Uncertainty(ABC):
    """A way to find the standard error of a shear."""

    @abstractmethod
    def error(self, terms: Terms) -> Float[Array, " 2"]:
        """Find the standard error of both components of the ratio of sums."""


@dataclass(frozen=True)
class Jackknife(Uncertainty):
    """Errors from leaving out one block of sources after the other.

    Parameters
    ----------
    blocks
        Number of blocks; sources are dealt out to them in turn.
    """

    blocks: int = 100

    def error(self, terms: Terms) -> Float[Array, " 2"]:
        """Take it from the scatter of the estimates without each block."""
        count = len(terms)
        block = np.arange(count) % min(self.blocks, count)
        value = np.stack([np.bincount(block, terms.value[:, i]) for i in (0, 1)], axis=-1)
        response = np.stack(
            [np.bincount(block, terms.response[:, i, j]) for i in (0, 1) for j in (0, 1)], axis=-1
        ).reshape(-1, 2, 2)
        total, slope = value.sum(axis=0), response.sum(axis=0)
        left = np.linalg.solve(slope - response, (total - value)[..., None])[..., 0]
        return jackknife_error(left)


@dataclass(frozen=True)
class Bootstrap(Uncertainty):
    """Errors from samples drawn with replacement.

    Parameters
    ----------
    resamples
        Number of samples that are drawn.
    seed
        Seed of the random numbers.
    """

    resamples: int = 1000
    seed: int = 1

    def error(self, terms: Terms) -> Float[Array, " 2"]:
        """Take it from the scatter of the estimates of the samples."""
        rng = np.random.default_rng(self.seed)
        count = len(terms)
        found = np.empty((self.resamples, 2))
        for row in found:
            drawn = rng.integers(count, size=count)
            row[:] = ratio(terms.select(drawn))
        return found.std(axis=0, ddof=1)


def ratio(terms: Terms) -> Float[Array, " 2"]:
    """Ratio of the sums, without the shear about which the terms are expanded."""
    return np.linalg.solve(terms.response.sum(axis=0), terms.value.sum(axis=0))


def jackknife_error(left: Float[Array, "block n"]) -> Float[Array, " n"]:
    """Take the standard error from the estimates without each block in turn."""
    count = len(left)
    error: Float[Array, " n"] = np.sqrt(
        (count - 1) / count * np.sum((left - left.mean(axis=0)) ** 2, axis=0)
    )
    return error
