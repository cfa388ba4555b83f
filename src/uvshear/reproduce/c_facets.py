"""Target ``c-facets``: additive bias with fixed facets and with facets that grow with zenith distance (section 6)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.additive_bias import PAIRED, AdditiveBiasTarget, additive_bias
from uvshear.reproduce.cell_counts import TableCount
from uvshear.reproduce.facet_ways import CellFacets, ExactFacetWay, FacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity, signed
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.typing import Array

MORE_CELLS = 50
"""Number of cells that are added for every 10 degrees."""

FACETS = {
    "fixed": "facets of Table 1",
    "growing": "growing by 50 cells per 10 deg",
    "exact": "exact facets",
}


@dataclass(frozen=True)
class FacetBias(AdditiveBiasTarget):
    """Additive bias with several kinds of facets.

    Parameters
    ----------
    distances
        Distances of the transit from the zenith [deg].
    """

    name = "c-facets"
    title = "Additive bias and the size of facets"

    galaxies: int = 250
    distances: tuple[float, ...] = (0.0, 20.0, 40.0, 60.0)

    def cases(self) -> Mapping[str, MockSurvey]:
        """Return a survey for each distance and each kind of facets."""
        found: dict[str, MockSurvey] = {}
        for distance in self.distances:
            ways: dict[str, FacetWay] = {
                "fixed": CellFacets(TableCount()),
                "growing": CellFacets(TableCount(MORE_CELLS * round(distance / 10))),
                "exact": ExactFacetWay(),
            }
            pointing = PaperPointing.from_zenith(math.radians(distance), self.integration)
            found |= {
                f"{name}-{distance:g}": MockSurvey(way, pointing, seed=self.seed)
                for name, way in ways.items()
            }
        return found

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare c of the three kinds of facets."""
        series: dict[str, tuple[list[Estimate], list[Estimate]]] = {
            name: ([], []) for name in FACETS
        }
        quantities = []
        for distance in self.distances:
            biases = {name: additive_bias(found, f"{name}-{distance:g}") for name in FACETS}
            for part in (0, 1):
                for name in FACETS:
                    series[name][part].append(biases[name][part])
                for name in ("fixed", "growing"):
                    quantities.append(
                        Quantity(
                            f"c{part + 1} at {distance:g} deg, SNR ≥ 10, {FACETS[name]}",
                            None,
                            biases[name][part],
                            biases["exact"][part],
                        )
                    )
        panels = [
            CurvePanel(
                "zenith distance [deg]",
                "additive bias",
                tuple(
                    Curve(
                        f"$c_{part + 1}$, {words}",
                        list(self.distances),
                        [estimate.value for estimate in series[way][part]],
                        [estimate.error or 0.0 for estimate in series[way][part]],
                    )
                    for way, words in ((name, "cells"), ("exact", FACETS["exact"]))
                    for part in (0, 1)
                ),
                FACETS[name],
                levels=(0.0,),
            )
            for name in ("fixed", "growing")
        ]
        caption = (
            "Additive bias of the mean of isolated galaxies with an SNR of 10 or more against the distance of the"
            " transit from the zenith, with the facets of Table 1 at all distances (left) and with facets that grow"
            " (right), each beside exact facets."
        )
        farthest = f"{self.distances[-1]:g}"
        fixed, growing = (series[name][0][-1] for name in ("fixed", "growing"))
        remark = (
            f"With the facets of Table 1 and with growing ones c1 differs by {signed(fixed.value - growing.value)} ±"
            f" {math.hypot(fixed.error or 0.0, growing.error or 0.0):.4f} at {farthest} deg."
            f" There are {self.galaxies} galaxies in each case. Numbers for the large facets of 1000² cells are in"
            " `c-zenith`."
        )
        return Finding(
            tuple(quantities), draw_curves(panels, has_common_y=True), caption, (PAIRED, remark)
        )
