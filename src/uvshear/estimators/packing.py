"""Likelihoods in a few kilobytes: the lattice by its columns, log L in thousandths, fluxes as a polynomial."""

from collections.abc import Mapping

import numpy as np

from uvshear.estimators.shape_likelihood import ShapeLikelihood
from uvshear.typing import Array, Float, Int

_UNIT = 1e-3
"""Of log L in the file: rounding is a part in 3000 of the likelihood."""

_DEEPEST = 32.0
_DEGREE = 4

Packed = Mapping[str, Array]

PACKED = ("lattice", "columns", "log_likelihood", "flux_terms", "variance_terms")


def pack(likelihood: ShapeLikelihood) -> Packed:
    """Arrays of float32 and int16."""
    order = np.lexsort(likelihood.point.T[::-1])
    point = likelihood.point[order]
    log_likelihood = likelihood.log_likelihood[order]
    # A column: neighbours along ln alpha, from some place on.
    breaks = np.any(point[1:] - point[:-1] != [0, 0, 1], axis=1)
    first = np.concatenate([[0], np.flatnonzero(breaks) + 1])
    count = np.diff(np.append(first, len(point)))
    below = np.clip(log_likelihood.max() - log_likelihood, 0, _DEEPEST)
    terms = _terms(point)
    weight = np.exp(-0.5 * np.minimum(below, 8.0))
    lattice = np.concatenate([likelihood.origin, likelihood.axes.ravel()])
    return {
        "lattice": lattice.astype(np.float32),
        "columns": np.column_stack([point[first], count]).astype(np.int16).ravel(),
        "log_likelihood": np.rint(below / _UNIT).astype(np.int16),
        "flux_terms": _fit(terms, likelihood.flux[order], weight),
        "variance_terms": _fit(terms, np.log(likelihood.flux_variance[order]), weight),
    }


def unpack(packed: Packed) -> ShapeLikelihood:
    """Likelihood as it was, but for rounding."""
    lattice = np.asarray(packed["lattice"], float)
    columns = np.asarray(packed["columns"], int).reshape(-1, 4)
    count = columns[:, 3]
    point = np.repeat(columns[:, :3], count, axis=0)
    point[:, 2] += np.arange(len(point)) - np.repeat(np.cumsum(count) - count, count)
    terms = _terms(point)
    return ShapeLikelihood(
        point,
        lattice[:3],
        lattice[3:].reshape(3, 3),
        -_UNIT * np.asarray(packed["log_likelihood"], float),
        terms @ np.asarray(packed["flux_terms"], float),
        np.exp(terms @ np.asarray(packed["variance_terms"], float)),
    )


def _terms(point: Int[Array, "node 3"]) -> Float[Array, "node term"]:
    """Products of Legendre polynomials over the box of the points, up to ``_DEGREE`` in all."""
    low, high = point.min(axis=0), point.max(axis=0)
    x = 2 * (point - low) / np.maximum(high - low, 1) - 1
    one = [np.polynomial.legendre.legvander(x[:, axis], _DEGREE) for axis in range(3)]
    powers = [
        (i, j, k)
        for i in range(_DEGREE + 1)
        for j in range(_DEGREE + 1 - i)
        for k in range(_DEGREE + 1 - i - j)
    ]
    return np.stack([one[0][:, i] * one[1][:, j] * one[2][:, k] for i, j, k in powers], axis=-1)


def _fit(
    terms: Float[Array, "node term"], values: Float[Array, " node"], weight: Float[Array, " node"]
) -> Float[Array, " term"]:
    found, *_ = np.linalg.lstsq(terms * weight[:, None], values * weight, rcond=1e-9)
    return found.astype(np.float32)
