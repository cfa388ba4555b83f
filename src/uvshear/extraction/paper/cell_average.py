"""Facets of Rivi & Miller 2018: visibilities phased to the source and averaged in square uv cells.

The model is sampled at the centres of the cells and not averaged over them. This is not the same (as their section 4.1
says) and reduces ellipticities by 2 to 5 per cent even without noise. These facets serve to reproduce the paper.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Final, Self

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.extraction.paper.facets import FacetBuilder, FacetMethod, Target, spectral_gain
from uvshear.extraction.paper.kernels import average_source
from uvshear.galaxy import Galaxies, Profile
from uvshear.geometry.directions import n_minus_one_at
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import Visibilities
from uvshear.predict.kernels import profile_arguments
from uvshear.typing import Array, Float

SLAB: Final = 16384
"""Number of rows that are averaged at a time; what is computed for them stays in the level-2 cache."""


class CellRule(ABC):
    """A rule for the number of cells of a facet."""

    @abstractmethod
    def cells(self, target: Target) -> int:
        """Return the number of cells along a side, which is even."""


@dataclass(frozen=True)
class ScaleLengths(CellRule):
    """2 ceil(uv_max x number x alpha) cells, with uv_max in wavelengths at the fluxes' reference frequency.

    This is the convention of the authors' program (``facet_size`` of RadioLensfit2, REF_FREQ 1.4 GHz): at 1.07 GHz a
    facet of 38 scale lengths is 49.7 wide. With uv_max at the observing frequency the slopes of
    measured against true ellipticity would be 0.952 and 0.907, whereas the authors' own C++ program has 0.958 and 0.947
    with facets of 38 scale lengths.
    """

    number: float = 38.0

    def cells(self, target: Target) -> int:
        """Return the number of cells to a side."""
        uv_max = target.uv_range.maximum * target.galaxy.reference_frequency / target.frequency
        return 2 * math.ceil(uv_max * self.number * target.scale_length)


@dataclass(frozen=True)
class PaperTable(CellRule):
    """Numbers of cells by flux density, as in Table 1 of Rivi & Miller 2018."""

    edges: tuple[float, ...] = (150e-6, 100e-6, 80e-6, 60e-6, 40e-6, 20e-6)
    sizes: tuple[int, ...] = (600, 550, 500, 460, 420, 350, 280)

    def cells(self, target: Target) -> int:
        """Return the number of cells to a side."""
        flux = float(target.galaxy.flux[0])
        return next(
            (
                size
                for edge, size in zip(self.edges, self.sizes, strict=False)
                if flux >= edge * (1 - 1e-9)
            ),
            self.sizes[-1],
        )


@dataclass(frozen=True)
class CellAverageFacets(FacetMethod):
    """Method that averages visibilities in cells out to the longest baseline."""

    averages_cells = True

    rule: CellRule = field(default_factory=ScaleLengths)

    def open(
        self,
        target: Target,
        profile: Profile,
        power: Float[Array, " cell"] | None = None,
    ) -> FacetBuilder:
        """Begin the facet of one source."""
        half = max(self.rule.cells(target) // 2, 8)
        return _CellAverageBuilder(target, profile, half)


def _direction(galaxy: Galaxies) -> Float[Array, " 3"]:
    """Return (l, m, n - 1) of a galaxy."""
    l, m = float(galaxy.l[0]), float(galaxy.m[0])
    return np.array([l, m, n_minus_one_at(l, m)])


class _CellAverageBuilder(FacetBuilder):
    def __init__(self, target: Target, profile: Profile, half: int) -> None:
        self._target, self._profile = target, profile
        self._cell = target.uv_range.maximum * (1 + 1e-9) / half
        self._sums = np.zeros((2 * half, half), complex)
        self._power = np.zeros((2 * half, half))

    def add(self, residual: Visibilities, model: Galaxies) -> None:
        galaxy, uv_range = self._target.galaxy, self._target.uv_range
        limits = uv_range.minimum, self._target.informative_uv_max
        centre, own = _direction(galaxy), _direction(model)
        form = np.stack(quadratic_form(model.ellipticity, model.scale_length), axis=-1)
        into = self._cell, self._sums, self._power
        frequency = residual.frequency
        gains, own_gains = (spectral_gain(each, frequency) for each in (galaxy, model))
        for chan, per_metre in enumerate(frequency / SPEED_OF_LIGHT):
            flux = float(model.flux[0]) * own_gains[chan]
            for start in range(0, len(residual), SLAB):
                rows = slice(start, start + SLAB)
                uvw = np.ascontiguousarray(residual.uvw[rows].T, float)
                samples = (
                    uvw,
                    residual.stokes_i[rows, chan],
                    residual.weights[rows, chan],
                )
                q = np.empty((1, uvw.shape[1]))
                profile_arguments(uvw, per_metre, own[None, :2] / (1 + own[2]), form, q)
                amplitude = flux * self._profile.envelope(q[0])
                average_source(
                    samples, per_metre, centre, own, amplitude, limits, gains[chan], into
                )

    def merge(self, later: Self) -> None:
        self._sums += later._sums
        self._power += later._power

    def facet(self, model: Galaxies) -> Facet:
        i, j = np.nonzero(self._power)
        half = self._power.shape[1]
        centres = np.column_stack([i - half + 0.5, j + 0.5]) * self._cell
        return Facet(centres, self._sums[i, j], self._power[i, j])
