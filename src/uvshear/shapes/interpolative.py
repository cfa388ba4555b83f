r"""Templates of a family represented by a few of the cells, for likelihoods over thousands of shapes.

The templates T of all ellipticities and sizes about one centre are nearly of low rank: their values on some cells p
determine those on all others, T(k) = sum_p T(k_p) X_pk. This is an interpolative decomposition, found by a pivoted QR
of random combinations of templates (Halko, Martinsson & Tropp 2011, SIAM Rev. 53, 217, sect. 3.2.3 and 5.2). The cells
p are sought among all cells near the origin and some of the others (``_candidates``); the coefficients X follow by
least squares. For any data d

.. math:: \sum_k d_k T(k) = \sum_p T(k_p) \Big(\sum_k X_{pk} d_k\Big)

and the same with squares holds for <m, m>. X does not depend on the data, so that it serves all facets with the same
cells and similar weights.
"""

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.linalg import qr, solve_triangular

from uvshear.execution.once import KeptOnce
from uvshear.galaxy import Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.interferometer.facet import Facet
from uvshear.shapes import kernels
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.maximum import LARGEST_ELLIPTICITY
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Complex, Float, Int

TOLERANCE = 3e-5
"""Error of a template over the norm of a typical template, both weighted by the noise of the facet."""

LEAST_POWER = 1e-4
"""Smallest weight of a cell in that norm, over the mean: other facets of the same cells may have data there."""

_RINGS = 16
"""Number of rings, each half an octave of the distance from the origin, within which all cells have the same weight, a
power of two. Facets of similar beams then share a decomposition, which depends on nothing but its key."""

_TEMPLATES, _COMBINATIONS = 1024, 400
"""Templates drawn from the family, and random combinations of these in the pivoted QR."""

MOST_CELLS = 20_000
"""Largest number of cells of a facet that is decomposed, which takes 0.1 GB then. The facet of a galaxy of usual size
has 7000; wider facets are those of bright galaxies, whose likelihoods are mostly computed without a decomposition."""

_MEMORY = 0.25e9
"""Memory for the decompositions that are kept [bytes]; that of a galaxy of usual size takes 16 MB."""

_CANDIDATES = 300
"""Largest number of cells in a ring among which the chosen cells are sought. Among all 7000 cells of a facet the search
takes three times as long, and the errors are the same: 4e-3 of the noise of each template in the root mean square."""

_CELLS_AT_A_TIME = 512
"""Number of cells on which all templates are evaluated at a time; their 2 MB fit into the caches."""

_BATCH = 256
"""Number of templates evaluated at a time; this many fit into the level-2 cache."""

_SIZE_STEP = 0.25
"""Spacing of the sizes ln(alpha) for which decompositions are made: sources of similar sizes share one."""

_SIZE_REACH = 4.5
"""Half-width of the sizes that a decomposition covers, in standard deviations of the prior."""


@dataclass(frozen=True)
class InterpolativeDecomposition:
    """Cells that determine all others: functions of the family are ``values[cells] @ coefficients`` everywhere."""

    cells: Int[Array, " chosen"]
    coefficients: Float[Array, "chosen cell"]


@dataclass(frozen=True)
class _Skeleton:
    """Cells that determine all others, and how their coefficients follow from the values of functions.

    Parameters
    ----------
    cells
        The chosen cells.
    triangle
        Triangle R of the decomposition Q R of the combinations on the chosen cells, each cell times the root of its
        weight.
    mixing
        The transpose of Q times the random numbers of the combinations. R X' is this matrix times the values of all
        functions on a cell, times the root of the cell's weight; X' are the coefficients times this root, over the
        roots of the chosen cells.
    root
        Root of the weights of the chosen cells.
    """

    cells: Int[Array, " chosen"]
    triangle: Float[Array, "chosen chosen"]
    mixing: Float[Array, "chosen function"]
    root: Float[Array, " chosen"]

    @classmethod
    def among(
        cls,
        candidates: Int[Array, " candidate"],
        values: Float[Array, "function candidate"],
        root: Float[Array, " candidate"],
    ) -> Self:
        """Choose the candidates that determine functions to ``TOLERANCE``; ``root`` is the root of their weights."""
        draws = np.random.default_rng(0).standard_normal((_COMBINATIONS, len(values)))
        combinations = (draws.astype(np.float32) @ values).astype(float) * root
        triangle, order = qr(combinations, mode="r", pivoting=True, check_finite=False)
        size = np.abs(np.diag(triangle))
        chosen = order[: np.count_nonzero(size > TOLERANCE * size[0])]
        q, triangle = qr(combinations[:, chosen], mode="economic", check_finite=False)
        single = triangle.astype(np.float32), (q.T @ draws).astype(np.float32)
        return cls(candidates[chosen], *single, root[chosen].astype(np.float32))

    def coefficients(
        self, values: Float[Array, "function cell"], root: Float[Array, " cell"]
    ) -> Float[Array, "chosen cell"]:
        """Return the coefficients of some cells from the values of all functions there.

        Single precision is enough: what is lost for a combination of the chosen cells that functions hardly contain is
        lost from functions that hardly contain it.
        """
        weighted = (self.mixing @ values) * root
        inner = solve_triangular(self.triangle, weighted, overwrite_b=True, check_finite=False)
        return inner * (self.root[:, None] / root)


@dataclass(frozen=True)
class TemplateDecomposition:
    """Interpolative decompositions of the templates, and of their squares, on the cells of a facet."""

    values: InterpolativeDecomposition
    squares: InterpolativeDecomposition

    def size_of(self) -> float:
        """Return the memory that the decomposition takes [bytes]."""
        return self.values.coefficients.nbytes + self.squares.coefficients.nbytes

    @classmethod
    def from_facet(
        cls,
        facet: Facet,
        profile: Profile,
        log_sizes: tuple[float, float],
        largest: float = LARGEST_ELLIPTICITY,
    ) -> Self:
        """Decompose the templates of all shapes within limits.

        Parameters
        ----------
        facet
            Facet that gives the cells and their power; its data are not used.
        profile
            Brightness profile of the templates.
        log_sizes
            Smallest and largest ln(scale length / rad).
        largest
            Largest modulus of the ellipticity.
        """
        from scipy.stats import qmc  # noqa: PLC0415 - takes two tenths of a second

        drawn = qmc.Sobol(3, seed=0).random(_TEMPLATES)
        e = largest * np.sqrt(drawn[:, 0]) * np.exp(2j * np.pi * drawn[:, 1])
        length = float(np.abs(facet.uv).max()) or 1.0
        size = 2 * np.pi * length * np.exp(log_sizes[0] + np.ptp(log_sizes) * drawn[:, 2])
        forms = np.stack(quadratic_form(e, size), axis=-1)
        xy, rings = (facet.uv.T / length).astype(np.float32), _rings(facet.uv)
        root = np.sqrt(_power_by_ring(facet)[rings]).astype(np.float32)

        candidates = _candidates(rings)
        values = _envelopes(xy[:, candidates], forms, profile)
        skeletons = [
            _Skeleton.among(candidates, functions, root[candidates])
            for functions in (values, values**2)
        ]
        found = [np.empty((len(each.cells), len(root)), np.float32) for each in skeletons]
        for start in range(0, len(root), _CELLS_AT_A_TIME):
            part = slice(start, start + _CELLS_AT_A_TIME)
            values = _envelopes(np.ascontiguousarray(xy[:, part]), forms, profile)
            for skeleton, functions, out in zip(skeletons, (values, values**2), found, strict=True):
                out[:, part] = skeleton.coefficients(functions, root[part])
        for skeleton, out in zip(skeletons, found, strict=True):
            out[:, skeleton.cells] = np.eye(len(out))
        return cls(
            *(
                InterpolativeDecomposition(skeleton.cells, out)
                for skeleton, out in zip(skeletons, found, strict=True)
            )
        )


class DecomposedCorrelator:
    """The sums of a :class:`Correlator` from the cells of a decomposition, for data at the correlator's centre."""

    def __init__(self, correlator: Correlator, decomposition: TemplateDecomposition) -> None:
        self._correlator = correlator
        self._values, squares = decomposition.values, decomposition.squares
        self._value_xy = correlator.xy[:, self._values.cells]
        self._square_xy = correlator.xy[:, squares.cells]
        self._power = squares.coefficients @ correlator.power

    def displaced_to(self, nodes: Float[Array, "node 2"]) -> Float[Array, "node chosen"]:
        """Real part of the data with each node moved to the origin, summed onto the chosen cells."""
        return self._correlator.displaced_to(nodes) @ self._values.coefficients.T

    def correlate(
        self,
        ellipticity: Complex[Array, " sample"],
        log_scale_length: Float[Array, " sample"],
        displaced: Float[Array, "node chosen"],
    ) -> tuple[Float[Array, "sample node"], Float[Array, " sample"]]:
        """Cross-correlation <d, m> of each template at each node, and <m, m> of each template."""
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


def _rings(uv: Float[Array, "cell 2"]) -> Int[Array, " cell"]:
    """Return the number of the ring in which each cell lies, counted from the farthest cell inwards."""
    distance = np.hypot(*uv.T)
    below = 2 * np.log2(distance.max() / np.maximum(distance, 1e-300))
    return np.minimum(below.astype(int), _RINGS - 1)


def _power_by_ring(facet: Facet) -> Float[Array, " ring"]:
    """Return the mean power in each ring over that of all cells, rounded so that similar beams have the same."""
    power, rings = np.asarray(facet.power, float), _rings(facet.uv)
    total = np.bincount(rings, power / power.mean(), _RINGS)
    mean = np.maximum(total / np.maximum(np.bincount(rings, minlength=_RINGS), 1), LEAST_POWER)
    return 2.0 ** np.rint(np.log2(mean))


def _candidates(rings: Int[Array, " cell"]) -> Int[Array, " candidate"]:
    """Return all cells of the inner rings, and some of each outer ring, where templates change slowly."""
    chosen = []
    for ring in range(_RINGS):
        cells = np.flatnonzero(rings == ring)
        places = np.linspace(0, len(cells) - 1, min(len(cells), _CANDIDATES))
        chosen.append(cells[places.astype(int)])
    return np.sort(np.concatenate(chosen))


class DecompositionCache:
    """Decompositions for facets of one profile; each is computed when it is first needed, and the last are kept."""

    def __init__(self, profile: Profile) -> None:
        self._profile = profile
        self._kept: KeptOnce[TemplateDecomposition] = KeptOnce(
            _MEMORY, TemplateDecomposition.size_of
        )

    def maker_for(
        self, facet: Facet, cells: Hashable, prior: ShapePrior
    ) -> Callable[[], TemplateDecomposition] | None:
        """Return a function that makes the decomposition for a facet; None where the facet has too many cells."""
        if len(facet.uv) > MOST_CELLS:
            return None
        return lambda: self.decomposition(facet, cells, prior)

    def decomposition(
        self, facet: Facet, cells: Hashable, prior: ShapePrior
    ) -> TemplateDecomposition:
        """Decomposition for a facet with these cells and a beam like this, and for the sizes that a prior allows.

        Parameters
        ----------
        facet
            Facet of the source.
        cells
            Hashable key that is equal for facets with the same cells.
        prior
            Prior of the source's shape.
        """
        weights = tuple(_power_by_ring(facet).tolist())
        step, sigma = round(prior.log_scale_length / _SIZE_STEP), prior.log_scale_length_sigma

        def work_out() -> TemplateDecomposition:
            middle, reach = step * _SIZE_STEP, _SIZE_REACH * sigma + _SIZE_STEP / 2
            return TemplateDecomposition.from_facet(
                facet, self._profile, (middle - reach, middle + reach)
            )

        return self._kept.value((cells, weights, step, sigma), work_out)
