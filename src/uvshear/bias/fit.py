"""Multiplicative and additive bias of an estimator, from the shears that it estimates.

The same galaxies are simulated with opposite shears and the same noise, so that shape noise and noise nearly cancel in
the difference of the two estimates, which gives m. Each galaxy is simulated with e and with -e, and with a realisation
of the noise and its negative, so that both cancel in the sum, which gives c.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from uvshear.errors import InputError
from uvshear.estimators.bias import Bias
from uvshear.estimators.uncertainty import jackknife_error
from uvshear.typing import Array, Bool, Float

LEAST_BLOCKS = 2
"""Smallest number of blocks of galaxies that give a standard error."""


@dataclass(frozen=True)
class TermSums:
    """Sums of an estimator's terms over blocks of galaxies.

    Parameters
    ----------
    values
        Two numbers and four of their response, for each block and each shear.
    n
        Number of galaxies that contribute.
    failed
        Number of measurements that failed.
    """

    values: Float[Array, "block shear 6"]
    n: int
    failed: int = 0

    @property
    def is_told(self) -> Bool[Array, " block"]:
        """Mask of the blocks that have a galaxy behind every shear."""
        return np.all(np.any(self.values[..., 2:] != 0, axis=-1), axis=-1)


def shears_from_sums(
    values: Float[Array, "... shear 6"], about: Sequence[complex]
) -> Float[Array, "... shear 2"]:
    """Return the shears that follow from sums of an estimator's terms: two values, and four of their response."""
    response = values[..., 2:].reshape(*values.shape[:-1], 2, 2)
    if np.any(np.all(response == 0, axis=(-2, -1))):
        raise InputError(
            "no galaxy contributes to the shear: none passes the cuts, or none was measured"
        )
    ratio = np.linalg.solve(response, values[..., :2, None])[..., 0]
    return ratio + np.array([[g.real, g.imag] for g in about])


def fit_bias(
    sums: TermSums,
    bins: Mapping[str, TermSums],
    shears: Sequence[complex],
    about: Sequence[complex],
) -> Bias:
    """Fit m and c of all galaxies and of each bin.

    Bins with galaxies in fewer than two blocks are left out.

    Parameters
    ----------
    sums
        Sums of the terms of all galaxies.
    bins
        Sums of the terms of the galaxies of each bin of flux, by the name of the bin.
    shears
        Shears that were applied, which add up to zero.
    about
        Shears about which the terms are expanded.
    """
    told = {name: part for name, part in bins.items() if part.is_told.sum() >= LEAST_BLOCKS}
    parts = tuple(_fit(name, part, shears, about) for name, part in told.items())
    return _fit("all", sums, shears, about, parts)


def _fit(
    name: str,
    sums: TermSums,
    shears: Sequence[complex],
    about: Sequence[complex],
    bins: tuple[Bias, ...] = (),
) -> Bias:
    values = sums.values[sums.is_told]
    if len(values) < LEAST_BLOCKS:
        raise InputError(
            f"{name}: {sums.n} galaxies in {len(values)} blocks are too few to estimate a standard error; more"
            " galaxies are needed"
        )
    g = np.array([[shear.real, shear.imag] for shear in shears])
    length = np.sum(g**2, axis=0)
    length[length == 0] = np.nan

    def fit(part: Float[Array, "... shear 6"]) -> Float[Array, "... 4"]:
        found = shears_from_sums(part, about)
        m = np.sum(g * found, axis=-2) / length - 1
        return np.concatenate([m, found.mean(axis=-2)], axis=-1)

    total = values.sum(axis=0)
    best, error = fit(total), jackknife_error(fit(total - values))
    response = total[:, [2, 5]].sum(axis=0) / sums.n
    return Bias(name, best[:2], error[:2], best[2:], error[2:], response, sums.n, sums.failed, bins)
