"""Target ``c-round``: the additive bias behind a PSF that a weighting has made round (sections 6 and 7)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from uvshear.constants import ARCSEC
from uvshear.diagnostics.weighting_loss import WeightingLoss, weighting_loss
from uvshear.galaxy import Exponential
from uvshear.interferometer.weighting import RoundPsf, Weighting, weighted
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.additive_bias import PAIRED, AdditiveBiasTarget, additive_bias
from uvshear.reproduce.cell_counts import TableCount
from uvshear.reproduce.facet_ways import CellFacets, ExactFacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.typing import Array

WAYS = {"exact": ExactFacetWay(), "cells": CellFacets(TableCount(100))}
"""Exact facets, and the paper's with 100 more cells than in Table 1, which also suit an anisotropic PSF."""

WEIGHTINGS: Mapping[str, tuple[Weighting, ...]] = {"natural": (), "round": (RoundPsf(),)}

DISC = 1.2 * ARCSEC
"""Scale length of the galaxy for which the cost of the weighting is stated [rad]."""


@dataclass(frozen=True)
class RoundBias(AdditiveBiasTarget):
    """Additive bias with natural weights and with weights that make the PSF round.

    Parameters
    ----------
    distances
        Distances of the transit from the zenith [deg].
    with_cells
        Number of galaxies with the paper's facets.
    """

    name = "c-round"
    title = "Additive bias behind a round PSF"

    distances: tuple[float, ...] = (0.0, 40.0, 60.0)
    with_cells: int = 400

    def cases(self) -> Mapping[str, MockSurvey]:
        """Return a survey for each distance, weighting and kind of facets."""
        return {
            _case(way, weighting, distance): MockSurvey(
                WAYS[way],
                PaperPointing.from_zenith(math.radians(distance), self.integration),
                WEIGHTINGS[weighting],
                seed=self.seed,
            )
            for way in WAYS
            for distance in self.distances
            for weighting in WEIGHTINGS
        }

    def galaxies_of(self, case: str) -> int:
        """Return the number of galaxies of a case."""
        return self.with_cells if case.startswith("cells") else self.galaxies

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare c with and without the weighting, and state its cost."""
        quantities = []
        series: dict[str, tuple[list[Estimate], list[Estimate]]] = {
            name: ([], []) for name in WEIGHTINGS
        }
        for distance in self.distances:
            for weighting in WEIGHTINGS:
                both = {way: additive_bias(found, _case(way, weighting, distance)) for way in WAYS}
                for part in (0, 1):
                    series[weighting][part].append(both["exact"][part])
                    quantities.append(
                        Quantity(
                            f"c{part + 1} at {distance:g} deg, SNR ≥ 10, {weighting} weights",
                            None,
                            both["cells"][part],
                            both["exact"][part],
                        )
                    )
            loss = self._loss(distance)
            quantities += [
                Quantity(
                    f"information on e{part + 1} that the round weights keep at {distance:g} deg",
                    own=Estimate(loss.information[part]),
                )
                for part in (0, 1)
            ]
        panels = [
            CurvePanel(
                "zenith distance [deg]",
                f"additive bias $c_{part + 1}$",
                tuple(
                    Curve(
                        f"{name} weights",
                        list(self.distances),
                        [estimate.value for estimate in both[part]],
                        [estimate.error or 0.0 for estimate in both[part]],
                    )
                    for name, both in series.items()
                ),
                levels=(0.0,),
            )
            for part in (0, 1)
        ]
        caption = (
            "Additive bias of the mean of isolated galaxies with an SNR of 10 or more, with natural weights and with"
            " weights that make the PSF round, against the distance of the transit from the zenith; exact facets."
        )
        remarks = (
            PAIRED,
            f"There are {self.galaxies} galaxies with exact facets and {self.with_cells} with the paper's facets,"
            " which have 100 cells more than in Table 1. The round weights remove the quadrupole of each ring of the uv"
            f" plane; their cost is stated for a disc of {DISC / ARCSEC:g} arcsec whose flux and size are not known.",
        )
        return Finding(tuple(quantities), draw_curves(panels), caption, remarks)

    def _loss(self, distance: float) -> WeightingLoss:
        pointing = PaperPointing.from_zenith(math.radians(distance), self.integration)
        observation = weighted(pointing.unit_visibilities(), WEIGHTINGS["round"])
        return weighting_loss(observation.map_baselines(), DISC, Exponential())


def _case(way: str, weighting: str, distance: float) -> str:
    return f"{way}-{weighting}-{distance:g}"
