"""Packing of likelihoods into a few kilobytes.

The lattice is described by its columns along ln alpha, the log likelihood is rounded to thousandths, and the flux and
the logarithm of its variance are polynomials of the coordinates of the nodes.
"""

from collections.abc import Mapping
from typing import Final, TypeAlias

import numpy as np

from uvshear.estimators.shape_likelihood import ShapeLikelihood
from uvshear.typing import Array, Float, Int

_UNIT = 1e-3
"""Unit of the packed log likelihood: rounding changes the likelihood by up to one part in 2000."""

_DEEPEST = 32.0
"""Log likelihood below the maximum at which it is cut off: a larger range does not fit into 16 bits."""

_DEGREE = 4
"""Degree of the polynomials of the flux and of its variance."""

_LATTICE = 12
"""Number of coordinates of the origin and of the axes of a lattice."""

_WIDEST = 1.5
"""Modulus of an ellipticity below which the nodes of a lattice are; those of galaxies are below 1."""

_BRIGHTEST = 1e6
"""Modulus below which fluxes are [Jy]."""

_LARGEST = 100.0
"""Modulus below which ln(alpha/rad) and ln(variance of the flux / Jy^2) are."""

Packed: TypeAlias = Mapping[str, Array]
"""One-dimensional arrays by the names of ``PACKED``."""

PACKED: Final = ("lattice", "columns", "log_likelihood", "flux_terms", "variance_terms")
"""Names of the arrays of a packed likelihood."""


def pack(likelihood: ShapeLikelihood) -> Packed:
    """Pack a likelihood into arrays of float32 and int16."""
    order = np.lexsort(likelihood.point.T[::-1])
    point = likelihood.point[order]
    log_likelihood = likelihood.log_likelihood[order]
    # A column of the lattice is a run of neighbours along ln alpha.
    breaks = np.any(point[1:] - point[:-1] != [0, 0, 1], axis=1)
    first = np.concatenate([[0], np.flatnonzero(breaks) + 1])
    count = np.diff(np.append(first, len(point)))
    below = np.clip(log_likelihood.max() - log_likelihood, 0, _DEEPEST)
    weight = np.exp(-0.5 * np.minimum(below, 8.0))
    flux_and_variance = np.column_stack(
        [likelihood.flux[order], np.log(likelihood.flux_variance[order])]
    )
    flux_terms, variance_terms = _fit(point, flux_and_variance, weight)
    lattice = np.concatenate([likelihood.origin, likelihood.axes.ravel()])
    return {
        "lattice": lattice.astype(np.float32),
        "columns": np.column_stack([point[first], count]).astype(np.int16).ravel(),
        "log_likelihood": np.rint(below / _UNIT).astype(np.int16),
        "flux_terms": flux_terms,
        "variance_terms": variance_terms,
    }


def is_whole(packed: Packed) -> bool:
    """Tell whether arrays can be those of a packed likelihood: their lengths and the ranges of their numbers agree."""
    if any(part.ndim != 1 or part.dtype.kind not in "fiu" for part in packed.values()):
        return False
    lattice, columns, log_likelihood, flux, variance = (
        packed[name].astype(float) for name in PACKED
    )
    if len(lattice) != _LATTICE or len(columns) % 4 or not len(columns):
        return False
    first, count = np.split(columns.reshape(-1, 4), [3], axis=1)
    below = log_likelihood * _UNIT
    return bool(
        _is_possible(lattice, first, first + [0, 0, 1] * (count - 1))
        and np.all(count >= 1)
        and count.sum() == len(below)
        # The largest likelihood is at a node.
        and below.min() == 0
        and below.max() <= _DEEPEST
        and len(flux) == len(variance) == len(_FIRST)
        and np.abs(flux).max() < _BRIGHTEST
        and np.abs(variance).max() < _LARGEST
    )


def _is_possible(lattice: Array, *ends: Array) -> bool:
    """Tell whether the nodes at both ends of all columns are ellipticities, and sizes of galaxies."""
    axes = lattice[3:].reshape(3, 3)
    if not (np.isfinite(lattice).all() and np.linalg.det(axes) != 0):
        return False
    e1, e2, size = np.moveaxis(lattice[:3] + np.stack(ends) @ axes.T, -1, 0)
    # The last axis is along the size.
    is_upright = not np.any(axes[:2, 2])
    return is_upright and bool(np.hypot(e1, e2).max() < _WIDEST and np.abs(size).max() < _LARGEST)


def unpack(packed: Packed) -> ShapeLikelihood:
    """Return the likelihood that was packed, up to rounding."""
    lattice = np.asarray(packed["lattice"], float)
    columns = np.asarray(packed["columns"], int).reshape(-1, 4)
    count = columns[:, 3]
    point = np.repeat(columns[:, :3], count, axis=0)
    point[:, 2] += np.arange(len(point)) - np.repeat(np.cumsum(count) - count, count)
    flux, log_variance = _evaluate(
        point, np.stack([packed["flux_terms"], packed["variance_terms"]]).astype(float)
    )
    return ShapeLikelihood(
        point,
        lattice[:3],
        lattice[3:].reshape(3, 3),
        -_UNIT * np.asarray(packed["log_likelihood"], float),
        flux,
        np.exp(log_variance),
    )


_FIRST, _SECOND, _THIRD = np.array(
    [
        (i, j, k)
        for i in range(_DEGREE + 1)
        for j in range(_DEGREE + 1 - i)
        for k in range(_DEGREE + 1 - i - j)
    ]
).T
"""Degrees of each term along the three axes of the lattice."""


def _legendre(
    point: Int[Array, "node 3"],
) -> tuple[Int[Array, "node 3"], list[Float[Array, "degree step"]]]:
    """Return each node's place in the bounding box of the nodes, and the polynomials at every step along its sides."""
    low, high = point.min(axis=0), point.max(axis=0)
    sides = [2 * np.arange(length + 1) / max(length, 1) - 1 for length in (high - low).tolist()]
    return point - low, [np.polynomial.legendre.legvander(side, _DEGREE).T for side in sides]


def _fit(
    point: Int[Array, "node 3"], values: Float[Array, "node 2"], weight: Float[Array, " node"]
) -> tuple[Float[Array, " term"], Float[Array, " term"]]:
    """Fit products of Legendre polynomials, up to the total degree ``_DEGREE``, to flux and log variance."""
    place, sides = _legendre(point)
    first, second, third = (side[:, place[:, axis]] for axis, side in enumerate(sides))
    terms = first[_FIRST] * second[_SECOND] * (third * weight)[_THIRD]
    found, *_ = np.linalg.lstsq(terms.T, values * weight[:, None], rcond=1e-9)
    flux_terms, variance_terms = found.astype(np.float32).T
    return flux_terms, variance_terms


def _evaluate(
    point: Int[Array, "node 3"], coefficients: Float[Array, "2 term"]
) -> Float[Array, "2 node"]:
    """Evaluate two sums of such products, first on the whole box, axis by axis, and then at the nodes."""
    place, (first, second, third) = _legendre(point)
    degrees = np.zeros((2, *[_DEGREE + 1] * 3))
    degrees[:, _FIRST, _SECOND, _THIRD] = coefficients
    box = first.T @ degrees.reshape(2, _DEGREE + 1, -1)
    box = second.T @ box.reshape(2, first.shape[1], _DEGREE + 1, _DEGREE + 1)
    box = (box.reshape(2, -1, _DEGREE + 1) @ third).reshape(2, -1)
    sizes = [side.shape[1] for side in (first, second, third)]
    return box[:, np.ravel_multi_index(tuple(place.T), sizes)]
