"""A ratio of sums, and its standard errors by the jackknife, which leaves out sources or patches of the sky in turn."""

import numpy as np

from uvshear.estimators.terms import Terms
from uvshear.typing import Array, Float, Int


def ratio(terms: Terms) -> Float[Array, " 2"]:
    """Return the ratio of the sums, without the shear of the expansion; NaN if the responses add up to zero."""
    return _solved(terms.response.sum(axis=0), terms.value.sum(axis=0)[:, None])[:, 0]


def ratio_error(terms: Terms, patch: Int[Array, " source"] | None = None) -> Float[Array, " 2"]:
    """Return the jackknife's standard errors of both components of the ratio.

    The order of the sources does not matter.

    Parameters
    ----------
    patch
        Number of the patch of the sky of each source. Patches are left out in turn; single sources unless given. With
        patches the errors include what neighbouring sources have in common.
    """
    value, response = terms.value, terms.response.reshape(-1, 4)
    if patch is not None:
        patches, number = np.unique(patch, return_inverse=True)
        value, response = (_sums(rows, number, len(patches)) for rows in (value, response))
    left = _solved(
        (response.sum(axis=0) - response).reshape(-1, 2, 2),
        (value.sum(axis=0) - value)[..., None],
    )[..., 0]
    return jackknife_error(left)


def _solved(
    response: Float[Array, "*part 2 2"], value: Float[Array, "*part 2 1"]
) -> Float[Array, "*part 2 1"]:
    """Return the ratios; NaN if one of the responses is singular."""
    try:
        return np.linalg.solve(response, value)
    except np.linalg.LinAlgError:
        return np.full(value.shape, np.nan)


def _sums(
    rows: Float[Array, "source n"], number: Int[Array, " source"], count: int
) -> Float[Array, "patch n"]:
    sums = np.zeros((count, rows.shape[1]))
    np.add.at(sums, number, rows)
    return sums


def jackknife_error(left: Float[Array, "part n"]) -> Float[Array, " n"]:
    """Return the jackknife's standard errors from the estimates without each part in turn."""
    count = len(left)
    error: Float[Array, " n"] = np.sqrt(
        (count - 1) / count * np.sum((left - left.mean(axis=0)) ** 2, axis=0)
    )
    return error
