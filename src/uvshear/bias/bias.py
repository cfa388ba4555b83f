"""Multiplicative and additive bias of an estimator, from the shears that it finds.

The same galaxies behind opposite shears, with the same noise: their difference is free of most of both. Each galaxy is
there with e and with -e, and with its noise and the opposite: intrinsic shapes and noise cancel in the sum, which shows
the additive bias.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uvshear.errors import InputError
from uvshear.estimators.ratio import jackknife_error
from uvshear.typing import Array, Bool, Float

LEAST_BLOCKS = 2


@dataclass(frozen=True)
class Bias:
    """g measured = (1 + m) g + c, component by component, with jackknife errors.

    Parameters
    ----------
    name
        Of the galaxies, by their flux.
    m, m_err, c, c_err
        Of both components.
    response
        Of the estimator's terms to both components, a galaxy with all of its measurements: by it galaxies of unlike
        fluxes share a total.
    n
        Galaxies, each measured several times.
    failed
        Measurements that came to nothing, and are left out.
    """

    name: str
    m: Float[Array, " 2"]
    m_err: Float[Array, " 2"]
    c: Float[Array, " 2"]
    c_err: Float[Array, " 2"]
    response: Float[Array, " 2"]
    n: int
    failed: int = 0

    def record(self) -> dict[str, float | int]:
        """Flat numbers for a file; those that were not found are left out."""
        numbers = {
            f"{name}{i + 1}{suffix}": float(value[i])
            for name, best, error in (("m", self.m, self.m_err), ("c", self.c, self.c_err))
            for i in (0, 1)
            for suffix, value in (("", best), ("_err", error))
        }
        found = {name: value for name, value in numbers.items() if np.isfinite(value)}
        responses = {f"response{i + 1}": float(self.response[i]) for i in (0, 1)}
        return found | responses | {"n": self.n, "failed": self.failed}


def shears_of(
    values: Float[Array, "... shear 6"], about: Sequence[complex]
) -> Float[Array, "... shear 2"]:
    """Shears that sums of an estimator's numbers (two, and four of their response) come to."""
    response = values[..., 2:].reshape(*values.shape[:-1], 2, 2)
    if np.any(np.all(response == 0, axis=(-2, -1))):
        raise InputError("no galaxy tells of the shear: none passes the cuts, or none was measured")
    ratio = np.linalg.solve(response, values[..., :2, None])[..., 0]
    return ratio + np.array([[g.real, g.imag] for g in about])


def is_told(values: Float[Array, "block shear 6"]) -> Bool[Array, " block"]:
    """Which blocks have a galaxy behind every shear."""
    return np.all(np.any(values[..., 2:] != 0, axis=-1), axis=-1)


def fit_bias(
    name: str,
    shears: Sequence[complex],
    about: Sequence[complex],
    values: Float[Array, "block shear 6"],
    n: int,
    failed: int = 0,
) -> Bias:
    """Fit m and c to ``shears`` that add up to zero, from sums over blocks of galaxies; m is NaN if all are zero.

    Blocks without a galaxy are left out; two are needed for an error.
    """
    values = values[is_told(values)]
    if len(values) < LEAST_BLOCKS:
        raise InputError(
            f"{name}: {n} galaxies in {len(values)} blocks; more galaxies are needed for an error"
        )
    g = np.array([[shear.real, shear.imag] for shear in shears])
    length = np.sum(g**2, axis=0)
    length[length == 0] = np.nan

    def fit(sums: Float[Array, "... shear 6"]) -> Float[Array, "... 4"]:
        found = shears_of(sums, about)
        m = np.sum(g * found, axis=-2) / length - 1
        return np.concatenate([m, found.mean(axis=-2)], axis=-1)

    total = values.sum(axis=0)
    best, error = fit(total), jackknife_error(fit(total - values))
    response = total[:, [2, 5]].sum(axis=0) / n
    return Bias(name, best[:2], error[:2], best[2:], error[2:], response, n, failed)
