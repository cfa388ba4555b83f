"""Standard errors of a ratio of sums, from the scatter of its terms."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from uvshear.estimators.terms import Terms
from uvshear.typing import Array, Float


class Uncertainty(ABC):
    """A method of estimating the standard errors of a shear."""

    @abstractmethod
    def error(self, terms: Terms) -> Float[Array, " 2"]:
        """Return the standard errors of both components of the ratio of sums."""


@dataclass(frozen=True)
class Jackknife(Uncertainty):
    """Jackknife: blocks of sources are left out in turn.

    Parameters
    ----------
    blocks
        Number of blocks, to which sources are assigned in turn.
    """

    blocks: int = 100

    def error(self, terms: Terms) -> Float[Array, " 2"]:
        """Return the standard errors from the scatter of the estimates without each block."""
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
    """Bootstrap: samples are drawn from the sources with replacement.

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
        """Return the standard errors from the scatter of the estimates of the drawn samples."""
        rng = np.random.default_rng(self.seed)
        count = len(terms)
        rows = np.concatenate([terms.value, terms.response.reshape(-1, 4)], axis=1)
        sums = np.empty((self.resamples, rows.shape[1]))
        for drawn in sums:
            times = np.bincount(rng.integers(count, size=count), minlength=count)
            drawn[:] = times @ rows
        found = np.linalg.solve(sums[:, 2:].reshape(-1, 2, 2), sums[:, :2, None])[..., 0]
        return found.std(axis=0, ddof=1)


def ratio(terms: Terms) -> Float[Array, " 2"]:
    """Return the ratio of the sums, without the shear of the expansion."""
    return np.linalg.solve(terms.response.sum(axis=0), terms.value.sum(axis=0))


def jackknife_error(left: Float[Array, "block n"]) -> Float[Array, " n"]:
    """Return the jackknife's standard errors from the estimates without each block in turn."""
    count = len(left)
    error: Float[Array, " n"] = np.sqrt(
        (count - 1) / count * np.sum((left - left.mean(axis=0)) ** 2, axis=0)
    )
    return error
