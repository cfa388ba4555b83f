"""Target ``facet-size``: slopes with the facets of Table 1, and the numbers of cells that a slope of 0.97 takes."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from uvshear.bias.cell_average import CellCount
from uvshear.constants import ARCMIN, MICROJANSKY
from uvshear.extraction.paper.cell_average import PaperTable
from uvshear.galaxy import PowerLawFlux
from uvshear.interferometer.weighting import Uniform, Weighting
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.cell_counts import FixedCount
from uvshear.reproduce.facet_ways import CellFacets, ExactFacetWay, FacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity, signed
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import BASELINE, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.psf_moments import SizesInApertures
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.reproduce.repeats import WithoutNoise
from uvshear.reproduce.shape_sample import (
    ShapeTask,
    measure_shapes,
    sample_named,
    shape_tasks,
)
from uvshear.simulation.population import Population
from uvshear.typing import Array, Float

BLOCK = 50
"""Number of galaxies in a part."""

SHORTER = 0.95
"""Part of the longest baseline up to which samples are used in an experiment."""

LOWER = 0.95
"""Slope at which the weightings are compared; with uniform weights not all bins reach the paper's 0.97."""

WEIGHTINGS: Mapping[str, tuple[Weighting, ...]] = {
    "natural": (),
    "uniform": (Uniform(2 * ARCMIN),),
}
"""Weightings of the search. The cells of the uniform weights are about those of Table 1."""


@dataclass(frozen=True)
class FluxRange:
    """A row of Table 1.

    Parameters
    ----------
    low, high
        Limits of the flux [uJy].
    cells
        Number of cells along a side of a facet.
    """

    low: float
    high: float
    cells: int

    def __str__(self) -> str:
        return f"{self.low:g}-{self.high:g}"


def table_rows() -> tuple[FluxRange, ...]:
    """Return the rows of Table 1, the brightest galaxies first."""
    table = PaperTable()
    edges = [200.0, *(round(edge / MICROJANSKY) for edge in table.edges), 10.0]
    return tuple(
        FluxRange(low, high, cells)
        for (high, low), cells in zip(pairwise(edges), table.sizes, strict=True)
    )


@dataclass(frozen=True)
class FacetSize(PaperTarget):
    """Slopes of the ellipticities of isolated galaxies in seven bins of flux.

    Parameters
    ----------
    pointing
        The observation.
    galaxies
        Number of galaxies in each bin.
    snr
        Smallest signal-to-noise ratio of galaxies of median size, that of the faintest in a bin.
    searched
        Number of galaxies, without noise, for each number of cells of the search.
    fractions
        Numbers of cells that are tried, over those of Table 1, for each weighting.
    """

    name = "facet-size"
    title = "Facet sizes and slopes"

    pointing: PaperPointing = BASELINE
    galaxies: int = 1000
    snr: float = 100.0
    searched: int = 100
    fractions: tuple[float, ...] = (0.15, 0.25, 0.4, 0.6, 0.8, 1.0, 1.3)

    def tasks(self) -> Mapping[str, ShapeTask]:
        """Return blocks of galaxies: with the facets of the table, with exact facets, and of the search."""
        found: dict[str, ShapeTask] = {}
        for row in table_rows():
            ways = {"cells": CellFacets(FixedCount(row.cells)), "exact": ExactFacetWay()}
            for name, way in ways.items():
                survey = self._survey(row, way)
                found |= shape_tasks(f"{name}-{row}", survey, self.galaxies, BLOCK)
            survey = self._survey(row, CellFacets(FixedCount(row.cells), SHORTER))
            found |= shape_tasks(f"shorter-{row}", survey, self.searched, BLOCK, WithoutNoise())
            for name, weightings in WEIGHTINGS.items():
                for cells in self._tried(row):
                    rule: CellCount = FixedCount(cells)
                    survey = self._survey(row, CellFacets(rule), weightings)
                    found |= shape_tasks(
                        f"{name}-{row}-{cells}", survey, self.searched, BLOCK, WithoutNoise()
                    )
        return found

    def measure(self, task: ShapeTask) -> Mapping[str, Array]:
        """Measure the shapes of a block of galaxies."""
        return measure_shapes(task)

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare the slopes of each bin with those of Table 1."""
        printed = PublishedFigures.read(self.name)
        rows = table_rows()
        published = [printed.estimates(f"slope_{name}") for name in ("e1", "e2")]
        quantities: list[Quantity] = []
        ours: list[list[Estimate]] = [[], []]
        searched: dict[str, list[float]] = {name: [] for name in WEIGHTINGS}
        largest: dict[str, list[float]] = {name: [] for name in WEIGHTINGS}
        reached: list[float] = []
        without_noise: list[tuple[float, float]] = []
        gained: list[list[float]] = []
        for k, row in enumerate(rows):
            slopes = [sample_named(found, f"{way}-{row}").slopes() for way in ("cells", "exact")]
            for part in (0, 1):
                as_paper, own = (
                    Estimate.from_slope(both[part].inverse_variance) for both in slopes
                )
                ours[part].append(as_paper)
                quantities.append(
                    Quantity(
                        f"slope of e{part + 1}, {row} µJy, {row.cells} cells",
                        published[part][k],
                        as_paper,
                        own,
                    )
                )
            curves = {name: self._curve(found, name, row) for name in WEIGHTINGS}
            for name, slope in curves.items():
                searched[name].append(self._cells_for(row, slope.mean(axis=1), LOWER))
                largest[name].append(float(slope.mean(axis=1)[-1]))
            threshold = printed.estimate("threshold").value
            reached.append(self._cells_for(row, curves["natural"].mean(axis=1), threshold))
            at_table = self._tried(row).index(row.cells)
            without_noise.append(tuple(curves["natural"][at_table].tolist()))
            shorter = sample_named(found, f"shorter-{row}").slopes()
            gained.append([each.inverse_variance.value for each in shorter])
        for k, row in enumerate(rows):
            published_cells = Estimate(float(row.cells))
            words = f"cells for a mean slope of 0.97, {row} µJy, natural weights"
            quantities.append(Quantity(words, published_cells, _if_reached(reached[k])))
            quantities += [
                Quantity(
                    f"cells for a mean slope of {LOWER:g}, {row} µJy, {name} weights",
                    None,
                    _if_reached(cells[k]),
                )
                for name, cells in searched.items()
            ]
        flux = [math.sqrt(row.low * row.high) for row in rows]
        panels = [
            self._slope_panel(flux, part, published[part], ours[part], without_noise)
            for part in (0, 1)
        ]
        panels.append(self._cell_panel(flux, rows, reached, searched))
        return Finding(
            tuple(quantities),
            draw_curves(panels),
            self._caption(),
            (
                *self._remarks(),
                _means_in_print(published),
                _largest_difference(quantities),
                _with_shorter_baselines(np.array(gained) - np.array(without_noise)),
                _compared(searched, largest),
            ),
            {f"cells, {name}": cells for name, cells in searched.items()}
            | {"cells, natural, slope 0.97": reached}
            | {"slopes without noise": without_noise},
        )

    def _survey(
        self, row: FluxRange, way: FacetWay, weightings: tuple[Weighting, ...] = ()
    ) -> MockSurvey:
        limits = PowerLawFlux(minimum=row.low * MICROJANSKY, maximum=row.high * MICROJANSKY)
        return MockSurvey(
            way,
            self.pointing,
            weightings,
            Population(flux=limits),
            flux=row.low * MICROJANSKY,
            snr=self.snr,
            seed=self.seed,
        )

    def _tried(self, row: FluxRange) -> list[int]:
        return [2 * round(row.cells * fraction / 2) for fraction in self.fractions]

    def _curve(
        self, found: Mapping[str, Mapping[str, Array]], name: str, row: FluxRange
    ) -> Float[Array, "tried 2"]:
        """Return the slopes of e1 and e2 without noise for each number of cells."""
        slopes = [
            sample_named(found, f"{name}-{row}-{cells}").slopes() for cells in self._tried(row)
        ]
        return np.array([[part.inverse_variance.value for part in both] for both in slopes])

    def _cells_for(self, row: FluxRange, slope: Float[Array, " tried"], threshold: float) -> float:
        cells = np.array(self._tried(row), float)
        return SizesInApertures(cells, slope).width_of(threshold)

    def _slope_panel(
        self,
        flux: list[float],
        part: int,
        published: list[Estimate],
        ours: list[Estimate],
        without_noise: list[tuple[float, float]],
    ) -> CurvePanel:
        return CurvePanel(
            "flux density [µJy]",
            f"slope of $e_{part + 1}$",
            (
                _curve_of("Rivi & Miller 2018, Table 1", flux, published, is_published=True),
                _curve_of("uvshear, facets of Table 1", flux, ours),
                Curve("the same without noise", flux, [pair[part] for pair in without_noise]),
            ),
            is_log=True,
            levels=(1.0,),
        )

    def _cell_panel(
        self,
        flux: list[float],
        rows: tuple[FluxRange, ...],
        reached: list[float],
        searched: Mapping[str, list[float]],
    ) -> CurvePanel:
        table = Curve(
            "Rivi & Miller 2018, Table 1",
            flux,
            [float(row.cells) for row in rows],
            is_published=True,
        )
        curves = [
            Curve("natural weights, slope 0.97", flux, reached),
            *(
                Curve(f"{name} weights, slope {LOWER:g}", flux, cells)
                for name, cells in searched.items()
            ),
        ]
        return CurvePanel(
            "flux density [µJy]",
            "cells along a side",
            (table, *curves),
            is_log=True,
        )

    def _caption(self) -> str:
        return (
            "Slopes of measured on true ellipticity, with weights 1/s² (s: error), of isolated galaxies in the bins of"
            " flux and with the facets of Table 1 (left, middle), with noise and, for fewer galaxies, without; and the"
            " number of cells with which the mean slope of e1 and e2 without noise reaches 0.97 and 0.95 (right)."
        )

    def _remarks(self) -> tuple[str, ...]:
        return (
            f"Each bin has {self.galaxies} galaxies at the phase centre. The noise gives the faintest galaxy of a bin,"
            f" at the median size, a signal-to-noise ratio of {self.snr:g}. The search for the number of cells uses"
            f" {self.searched} galaxies without noise; a number is given where the slope crosses 0.97 or {LOWER:g}"
            f" between {self.fractions[0]:g} and {self.fractions[-1]:g} times the cells of Table 1.",
        )


def _largest_difference(quantities: Sequence[Quantity]) -> str:
    """Say how far the slopes in the paper's way are from those of the table."""
    pairs = [
        (row.as_paper.value - row.paper.value, row)
        for row in quantities
        if row.name.startswith("slope") and row.as_paper is not None and row.paper is not None
    ]
    mean = sum(difference for difference, _ in pairs) / len(pairs)
    in_print, here = (
        [estimate.error or 0.0 for _, row in pairs if (estimate := getattr(row, way)) is not None]
        for way in ("paper", "as_paper")
    )
    # Our bins have the same random numbers; only those of e1 and e2 are independent.
    error = math.hypot(
        math.sqrt(sum(each**2 for each in in_print)) / len(pairs),
        sum(here) / len(here) / math.sqrt(2),
    )
    below = sum(difference < 0 for difference, _ in pairs)
    largest, row = max(pairs, key=lambda pair: abs(pair[0]))
    beyond = sum(abs(pull) > 2 for _, each in pairs if (pull := each.pull) is not None)
    return (
        f"Of the {len(pairs)} slopes {below} are below those of Table 1, and {beyond} differ from them by more than two"
        f" errors. The mean difference is {signed(mean)} ± {error:.4f}, and the largest {signed(largest)} ({row.name})."
        " Our bins share their random numbers, so that their differences are not independent."
    )


def _with_shorter_baselines(gain: Float[Array, "row 2"]) -> str:
    """Say how slopes depend on the longest baseline, which sets the width of the cells."""
    first, second = (signed(float(part)) for part in gain.mean(axis=0))
    return (
        "The width of a facet is its number of cells divided by twice the longest baseline, which is not that of the"
        " paper, because its layout of the array is an earlier one. In an experiment without the samples beyond"
        f" {SHORTER:g} of the longest baseline, which are one in ten thousand, the slopes without noise change by"
        f" {first} (e1) and {second} (e2) in the mean over the bins. A somewhat shorter longest baseline would thus"
        " remove such differences; that of the paper's array is not stated."
    )


def _means_in_print(published: Sequence[Sequence[Estimate]]) -> str:
    """Say which mean slopes the paper has with its cells."""
    means = [(first.value + second.value) / 2 for first, second in zip(*published, strict=True)]
    return (
        f"The paper's own mean slopes of e1 and e2 with its cells are {min(means):.3f} to {max(means):.3f}."
        f" A slope of {LOWER:g} is searched for as well, because uniform weights do"
        " not reach 0.97 in all bins."
    )


def _if_reached(cells: float) -> Estimate | None:
    return Estimate(float(round(cells))) if math.isfinite(cells) else None


def _compared(
    searched: Mapping[str, Sequence[float]], largest: Mapping[str, Sequence[float]]
) -> str:
    """Say how much smaller facets with uniform weights may be."""
    ratio = np.array(searched["uniform"]) / np.array(searched["natural"])
    known = ratio[np.isfinite(ratio)]
    if len(known) == 0:
        return f"No bin reaches a slope of {LOWER:g} with both weightings."
    ends = {name: f"{min(slopes):.3f} to {max(slopes):.3f}" for name, slopes in largest.items()}
    return (
        f"For a slope of {LOWER:g} uniform weights need {known.min():.2f} to {known.max():.2f} times as many cells"
        " along a side as natural weights, as the paper expects. Their slopes grow little with larger facets: with the"
        f" largest ones they are {ends['uniform']}, and those with natural weights {ends['natural']}."
    )


def _curve_of(
    label: str, x: list[float], estimates: list[Estimate], *, is_published: bool = False
) -> Curve:
    return Curve(
        label,
        x,
        [estimate.value for estimate in estimates],
        [estimate.error or 0.0 for estimate in estimates],
        is_published=is_published,
    )
