r"""All templates of a family on a few of the cells: what a likelihood over thousands of shapes needs of a facet.

Templates T of all ellipticities and sizes about one centre are nearly of low rank. On some cells p they tell what they
are on all others, T(k) = sum_p T(k_p) X_pk (an interpolative decomposition, by pivoted QR of random combinations of
templates: Halko, Martinsson & Tropp 2011, SIAM Rev. 53, 217, sect. 3.2.3 and 5.2), so that for any data

.. math:: \sum_k d_k T(k) = \sum_p T(k_p) \Big(\sum_k X_{pk} d_k\Big)

and the same with squares for <m, m>. No data enter X: it serves all facets of the same cells, and of weights alike.
"""

from collections.abc import Hashable
from dataclasses import dataclass
from threading import Lock
from typing import Self

import numpy as np
from scipy.linalg import qr, solve_triangular
from scipy.stats import qmc

from uvshear.galaxy import Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.interferometer.facet import Facet
from uvshear.shapes import kernels
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.maximum import LARGEST_ELLIPTICITY
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Complex, Float, Int

TOLERANCE = 3e-5
"""Error of a template over the norm of a typical one, both as the noise of the facet weighs them."""

LEAST_POWER = 1e-4
"""Of a cell, over the mean, in that weight: other facets of the same cells may have data there."""

_SAMPLES = 1024
_COMBINATIONS = 400
_BATCH = 256
"""Templates at a time: theirs stay in the second-level cache."""


@dataclass(frozen=True)
class Skeleton:
    """Cells that stand for all: functions of the family are ``values[cells] @ spread`` everywhere."""

    cells: Int[Array, " chosen"]
    spread: Float[Array, "chosen cell"]

    @classmethod
    def of(cls, functions: Float[Array, "function cell"], weight: Float[Array, " cell"]) -> Self:
        """Choose the cells by which functions are known to ``TOLERANCE`` in the norm of a ``weight``."""
        rng = np.random.default_rng(0)
        mixing = rng.standard_normal((_COMBINATIONS, len(functions))) / np.sqrt(len(functions))
        root = np.sqrt(weight)
        triangle, order = qr(mixing @ (functions * root), mode="r", pivoting=True)
        size = np.abs(np.diag(triangle))
        rank = int(np.sum(size > TOLERANCE * size[0]))
        inner = solve_triangular(triangle[:rank, :rank], triangle[:rank, rank:])
        spread = np.empty((rank, functions.shape[1]))
        spread[:, order[:rank]] = np.eye(rank)
        spread[:, order[rank:]] = inner
        spread *= root[order[:rank], None] / root
        return cls(order[:rank], spread.astype(np.float32))


@dataclass(frozen=True)
class Condensation:
    """Skeletons of the templates and of their squares on the cells of a facet."""

    values: Skeleton
    squares: Skeleton

    @classmethod
    def of(
        cls,
        facet: Facet,
        profile: Profile,
        log_sizes: tuple[float, float],
        largest: float = LARGEST_ELLIPTICITY,
    ) -> Self:
        """Of all ellipticities up to ``largest``, and ln(scale length / rad) from one to the other."""
        drawn = qmc.Sobol(3, seed=0).random(_SAMPLES)
        e = largest * np.sqrt(drawn[:, 0]) * np.exp(2j * np.pi * drawn[:, 1])
        size = 2 * np.pi * np.exp(log_sizes[0] + (log_sizes[1] - log_sizes[0]) * drawn[:, 2])
        envelopes = _envelopes(facet.uv.T, np.stack(quadratic_form(e, size), axis=-1), profile)
        power = np.asarray(facet.power, float)
        weight = np.maximum(power / power.mean(), LEAST_POWER)
        return cls(Skeleton.of(envelopes, weight), Skeleton.of(envelopes**2, weight))


class CondensedCorrelator:
    """Sums over cells as of a :class:`Correlator`, from its data at the centre that it has."""

    def __init__(self, correlator: Correlator, condensation: Condensation) -> None:
        self._correlator = correlator
        self._values, squares = condensation.values, condensation.squares
        self._value_xy = correlator.xy[:, self._values.cells]
        self._square_xy = correlator.xy[:, squares.cells]
        self._power = squares.spread @ correlator.power

    def displaced_to(self, nodes: Float[Array, "node 2"]) -> Float[Array, "node chosen"]:
        """Condense the real part of the data with each node moved to the origin."""
        return self._correlator.displaced_to(nodes) @ self._values.spread.T

    def correlate(
        self,
        ellipticity: Complex[Array, " sample"],
        log_scale_length: Float[Array, " sample"],
        displaced: Float[Array, "node chosen"],
    ) -> tuple[Float[Array, "sample node"], Float[Array, " sample"]]:
        """Cross-correlation <d, m> of each template at each node, and its <m, m>."""
        correlator = self._correlator
        size = np.exp(log_scale_length) / correlator.length
        forms = np.stack(quadratic_form(ellipticity, size), axis=-1)
        heights, norm = np.empty((len(forms), len(displaced))), np.empty(len(forms))
        for first in range(0, len(forms), _BATCH):
            batch = slice(first, first + _BATCH)
            values = _envelopes(self._value_xy, forms[batch], correlator.profile)
            squares = _envelopes(self._square_xy, forms[batch], correlator.profile)
            heights[batch] = values @ displaced.T
            norm[batch] = squares**2 @ self._power
        return heights, norm


def _envelopes(
    xy: Float[Array, "2 cell"], forms: Float[Array, "sample 3"], profile: Profile
) -> Float[Array, "sample cell"]:
    q = np.empty((len(forms), xy.shape[1]), xy.dtype)
    kernels.quadratics(xy[0], xy[1], forms, q)
    return profile.envelope(q)


_RUNG = 0.25
_REACH = 4.5


class Condenser:
    """Condensations of facets, each made when it is first asked for and kept."""

    def __init__(self, profile: Profile) -> None:
        self._profile = profile
        self._known: dict[tuple[Hashable, float, int, float], Condensation] = {}
        self._lock = Lock()

    def of(self, facet: Facet, cells: Hashable, prior: ShapePrior) -> Condensation:
        """For a facet of such ``cells`` and such a beam, and the sizes of a prior."""
        rung, sigma = round(prior.log_scale_length / _RUNG), prior.log_scale_length_sigma
        beam = round(float(facet.power[0] / np.mean(facet.power)), 4)
        key = cells, beam, rung, sigma
        # One thread makes it, from the same facet whichever comes first.
        with self._lock:
            if key not in self._known:
                middle, reach = rung * _RUNG, _REACH * sigma + _RUNG / 2
                sizes = middle - reach, middle + reach
                self._known[key] = Condensation.of(facet, self._profile, sizes)
            return self._known[key]

    def __getstate__(self) -> dict[str, object]:
        """Locks do not travel between processes."""
        return {"_profile": self._profile, "_known": self._known}

    def __setstate__(self, state: dict[str, object]) -> None:
        """Take a lock of its own."""
        self.__dict__.update(state)
        self._lock = Lock()
