"""Target ``c-zenith``: additive bias against zenith distance at several signal-to-noise ratios (section 6)."""

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.additive_bias import PAIRED, AdditiveBiasTarget, additive_bias
from uvshear.reproduce.cell_counts import FixedCount
from uvshear.reproduce.facet_ways import CellFacets, ExactFacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity, signed
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.typing import Array

WAYS = {"cells": CellFacets(FixedCount(1000)), "exact": ExactFacetWay()}

WORDS = {"cells": "facets of 1000² cells", "exact": "exact facets"}

PAPER_DISTANCE = 0.83
"""Distance of the paper's declination from its zenith, -30 deg 49' 48" [deg]."""

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
        series: dict[tuple[str, int, float], list[Estimate]] = defaultdict(list)
        for least in LEAST:
            for distance in self.distances:
                both = {way: additive_bias(found, _case(way, distance), least) for way in WAYS}
                for part in (0, 1):
                    for way in WAYS:
                        series[way, part, least].append(both[way][part])
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
        panels = [
            self._panel(way, part, {least: series[way, part, least] for least in LEAST}, printed)
            for way in WAYS
            for part in (0, 1)
        ]
        caption = (
            "Additive bias of the mean of isolated galaxies against the distance of the transit from the zenith, above"
            " several signal-to-noise ratios: with facets of 1000² cells (above) and with exact facets (below)."
            " Crosses: Table 2 for SNR ≥ 10 (the larger values) and SNR ≥ 25."
        )
        remarks = (
            PAIRED,
            f"There are {self.galaxies} galaxies with exact facets and {self.with_cells} with facets of 1000² cells."
            f" The paper's numbers are those of Table 2 for a declination of −30 deg, which is {PAPER_DISTANCE:.1f}"
            " deg from the zenith of its array; for their cause see `shear-bias`.",
            f"At {self.distances[-1]:g} deg c1 with facets of 1000² cells is {self._farthest(series, LEAST[0])} at an"
            f" SNR of {LEAST[0]:g} or more, and {self._farthest(series, LEAST[-1])} at {LEAST[-1]:g} or more.",
        )
        picture = draw_curves(panels, rows=len(WAYS), has_common_y=True)
        return Finding(tuple(quantities), picture, caption, remarks)

    @staticmethod
    def _farthest(series: Mapping[tuple[str, int, float], list[Estimate]], least: float) -> str:
        """Write c1 with cells at the largest distance."""
        c1 = series["cells", 0, least][-1]
        return f"{signed(c1.value)} ± {c1.error or 0.0:.4f}"

    def _panel(
        self,
        way: str,
        part: int,
        series: Mapping[float, list[Estimate]],
        printed: PublishedFigures,
    ) -> CurvePanel:
        """Return the panel of one component with one kind of facets."""
        curves = [
            Curve(
                f"SNR ≥ {least:g}",
                list(self.distances),
                [estimate.value for estimate in estimates],
                [estimate.error or 0.0 for estimate in estimates],
            )
            for least, estimates in series.items()
        ]
        if way == "cells":
            known = [printed.estimate(f"c{part + 1}_snr{least}") for least in (10, 25)]
            curves.append(
                Curve(
                    "Rivi & Miller 2018",
                    [PAPER_DISTANCE] * len(known),
                    [estimate.value for estimate in known],
                    [estimate.error or 0.0 for estimate in known],
                    is_published=True,
                    is_line=False,
                )
            )
        return CurvePanel(
            "zenith distance [deg]",
            f"additive bias $c_{part + 1}$",
            tuple(curves),
            title=WORDS[way],
            levels=(0.0,),
        )


def _case(way: str, distance: float) -> str:
    return f"{way}-{distance:g}"
