"""Target ``c-zenith``: additive bias against zenith distance at several signal-to-noise ratios (section 6)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.additive_bias import PAIRED, AdditiveBiasTarget, additive_bias
from uvshear.reproduce.cell_counts import FixedCount
from uvshear.reproduce.facet_ways import CellFacets, ExactFacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.typing import Array

WAYS = {"cells": CellFacets(FixedCount(1000)), "exact": ExactFacetWay()}

LEAST = (10.0, 15.0, 25.0, 50.0)
"""Smallest fluxes [uJy], which are also the smallest signal-to-noise ratios (see ``shear_bias``)."""


@dataclass(frozen=True)
class ZenithBias(AdditiveBiasTarget):
    """Additive bias at several distances from the zenith.

    Parameters
    ----------
    distances
        Distances of the transit from the zenith [deg].
    with_cells
        Number of galaxies with the paper's facets of 1000² cells, which take more time than exact ones.
    """

    name = "c-zenith"
    title = "Additive bias against zenith distance"

    distances: tuple[float, ...] = (0.0, 20.0, 40.0, 60.0)
    with_cells: int = 150

    def cases(self) -> Mapping[str, MockSurvey]:
        """Return a survey for each distance and each kind of facets."""
        return {
            _case(way, distance): MockSurvey(
                WAYS[way],
                PaperPointing.from_zenith(math.radians(distance), self.integration),
                seed=self.seed,
            )
            for way in WAYS
            for distance in self.distances
        }

    def galaxies_of(self, case: str) -> int:
        """Return the number of galaxies of a case."""
        return self.with_cells if case.startswith("cells") else self.galaxies

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare c at each distance."""
        printed = PublishedFigures.read(self.name)
        quantities = []
        curves: dict[str, list[list[Estimate]]] = {"c1": [], "c2": []}
        for least in LEAST:
            series: tuple[list[Estimate], list[Estimate]] = ([], [])
            for distance in self.distances:
                both = {way: additive_bias(found, _case(way, distance), least) for way in WAYS}
                for part in (0, 1):
                    series[part].append(both["exact"][part])
                    key = f"c{part + 1}_snr{least:g}"
                    is_printed = distance == 0 and key in printed.values
                    quantities.append(
                        Quantity(
                            f"c{part + 1} at {distance:g} deg, SNR ≥ {least:g}",
                            printed.estimate(key) if is_printed else None,
                            both["cells"][part],
                            both["exact"][part],
                        )
                    )
            curves["c1"].append(series[0])
            curves["c2"].append(series[1])
        distances = list(self.distances)
        panels = [
            CurvePanel(
                "zenith distance [deg]",
                f"additive bias $c_{name[1]}$",
                tuple(
                    Curve(
                        f"SNR ≥ {least:g}",
                        distances,
                        [estimate.value for estimate in series],
                        [estimate.error or 0.0 for estimate in series],
                    )
                    for least, series in zip(LEAST, parts, strict=True)
                ),
                levels=(0.0,),
            )
            for name, parts in curves.items()
        ]
        caption = (
            "Additive bias of the mean of isolated galaxies against the distance of the transit from the zenith, with"
            " exact facets, above several signal-to-noise ratios."
        )
        remarks = (
            PAIRED,
            f"There are {self.galaxies} galaxies with exact facets and {self.with_cells} with facets of 1000² cells."
            " The paper's numbers are those of Table 2 for a declination of −30 deg, which is 0.7 deg from the zenith.",
        )
        return Finding(tuple(quantities), draw_curves(panels), caption, remarks)


def _case(way: str, distance: float) -> str:
    return f"{way}-{distance:g}"
