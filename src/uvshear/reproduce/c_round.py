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
from uvshear.reproduce.facet_ways import CellFacets, ExactFacetWay, FacetWay, RoundNoise
from uvshear.reproduce.finding import Estimate, Finding, Quantity, signed
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.partial_weighting import PartialWeighting
from uvshear.typing import Array

EXACT, CELLS = ExactFacetWay(), CellFacets(TableCount(100))
"""Exact facets, and the paper's with 100 more cells than in Table 1, which also suit an anisotropic PSF."""


@dataclass(frozen=True)
class Case:
    """A kind of weights and of facets.

    Parameters
    ----------
    words
        Name for the reader.
    facets
        Way to make facets.
    weightings
        Weightings of the visibilities.
    """

    words: str
    facets: FacetWay
    weightings: tuple[Weighting, ...] = ()


CASES: Mapping[str, Case] = {
    "natural": Case("natural weights", EXACT),
    "round": Case("weights for a round PSF", EXACT, (RoundPsf(),)),
    "half": Case(
        "half of the weighting for a round PSF", EXACT, (PartialWeighting(RoundPsf(), 0.5),)
    ),
    "naturalcells": Case("natural weights", CELLS),
    "roundcells": Case("weights for a round PSF", CELLS, (RoundPsf(),)),
    "roundnoise": Case(
        "weights for a round PSF, experiment: noise as round as the PSF",
        RoundNoise(),
        (RoundPsf(),),
    ),
}
"""What is compared at each distance from the zenith; the experiment is made at the largest one."""

DISC = 1.2 * ARCSEC
"""Scale length of the galaxy for which the cost of the weighting is stated [rad]."""


@dataclass(frozen=True)
class RoundBias(AdditiveBiasTarget):
    """Additive bias with natural weights and with weights that make the PSF round.

    Parameters
    ----------
    distances
        Distances of the transit from the zenith [deg].
    grown
        Numbers of galaxies at these distances over ``galaxies``; c varies more from galaxy to galaxy at large ones.
    fewer
        Number of galaxies of the other cases: with the paper's facets, half-way, and in the experiment.
    """

    name = "c-round"
    title = "Additive bias with a round PSF"

    distances: tuple[float, ...] = (0.0, 40.0, 60.0)
    grown: tuple[float, ...] = (1.0, 1.2, 2.4)
    fewer: int = 400

    def cases(self) -> Mapping[str, MockSurvey]:
        """Return a survey for each distance and case."""
        return {
            f"{name}-{distance:g}": MockSurvey(
                case.facets,
                PaperPointing.from_zenith(math.radians(distance), self.integration),
                case.weightings,
                seed=self.seed,
            )
            for name, case in CASES.items()
            for distance in self.distances
            if name != "roundnoise" or distance == self.distances[-1]
        }

    def galaxies_of(self, case: str) -> int:
        """Return the number of galaxies of a case."""
        name, _, distance = case.partition("-")
        if name not in {"natural", "round"}:
            return self.fewer
        return round(self.galaxies * self.grown[self.distances.index(float(distance))])

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare c with and without the weighting, and state its cost."""
        c = {case: additive_bias(found, case) for case in self.cases()}
        quantities = []
        for distance in self.distances:
            for name in ("natural", "round", "half", "roundnoise"):
                if (case := f"{name}-{distance:g}") not in c:
                    continue
                cells = c.get(f"{name}cells-{distance:g}", (None, None))
                quantities += [
                    Quantity(
                        f"c{part + 1} at {distance:g} deg, SNR ≥ 10, {CASES[name].words}",
                        None,
                        cells[part],
                        c[case][part],
                    )
                    for part in (0, 1)
                ]
            quantities += [
                Quantity(
                    f"fraction of the information on e{part + 1} at {distance:g} deg, {CASES[name].words}",
                    own=Estimate(loss.information[part]),
                )
                for name in ("round", "half")
                for loss in (self._loss(distance, name),)
                for part in (0, 1)
            ]
        panels = [
            CurvePanel(
                "zenith distance [deg]",
                f"additive bias $c_{part + 1}$",
                tuple(self._curve(c, name, part) for name in ("natural", "round", "half")),
                levels=(0.0,),
            )
            for part in (0, 1)
        ]
        caption = (
            "Additive bias of the mean of isolated galaxies with an SNR of 10 or more, with natural weights, with"
            " weights that make the PSF round, and with half of this weighting, against the distance of the"
            " transit from the zenith; exact facets."
        )
        return Finding(
            tuple(quantities), draw_curves(panels, has_common_y=True), caption, self._remarks(c)
        )

    def _curve(self, c: Mapping[str, tuple[Estimate, Estimate]], name: str, part: int) -> Curve:
        estimates = [c[f"{name}-{distance:g}"][part] for distance in self.distances]
        return Curve(
            CASES[name].words,
            list(self.distances),
            [estimate.value for estimate in estimates],
            [estimate.error or 0.0 for estimate in estimates],
        )

    def _remarks(self, c: Mapping[str, tuple[Estimate, Estimate]]) -> tuple[str, ...]:
        farthest = f"{self.distances[-1]:g}"
        words = {
            name: f"{signed(c[f'{name}-{farthest}'][0].value)} ± {c[f'{name}-{farthest}'][0].error:.4f}"
            for name in ("natural", "round", "half", "roundnoise")
        }
        nearest = f"{self.distances[0]:g}"
        moduli = {name: _modulus(c[f"{name}-{nearest}"]) for name in ("natural", "round", "half")}
        distances = ", ".join(f"{each:g}" for each in self.distances)
        numbers = ", ".join(str(self.galaxies_of(f"natural-{each:g}")) for each in self.distances)
        return (
            PAIRED,
            f"With exact facets, natural weights and weights for a round PSF have {numbers} galaxies at"
            f" {distances} deg; all other cases have {self.fewer}. The paper's facets have 100 cells more than in"
            " Table 1. The weights for a round PSF remove the quadrupole of each ring of the uv plane. The fraction of"
            " the information, the square of the signal-to-noise ratio of the ellipticity, is that of a disc of"
            f" {DISC / ARCSEC:g} arcsec whose flux and size are not known.",
            f"At {nearest} deg the modulus of c is {moduli['natural']} with natural weights, {moduli['round']} with"
            f" weights for a round PSF, and {moduli['half']} with half of this weighting.",
            f"Weights that make the PSF round change c1 at {farthest} deg from {words['natural']} to {words['round']}."
            " The weights multiply the natural weights w by factors T. The PSF follows from"
            " w T, whereas the variance of the noise in the uv plane follows from w T², so that with a round PSF the"
            " power of the noise is larger along the other direction. In an experiment with noise that is as round as"
            f" the PSF, which no data can give, c1 is {words['roundnoise']}. With half of the weighting, the mean of"
            f" 1 and T, the power of the noise is isotropic to first order, and c1 is {words['half']}.",
        )

    def _loss(self, distance: float, case: str) -> WeightingLoss:
        pointing = PaperPointing.from_zenith(math.radians(distance), self.integration)
        observation = weighted(pointing.unit_visibilities(), CASES[case].weightings)
        return weighting_loss(observation.map_baselines(), DISC, Exponential())


def _modulus(c: tuple[Estimate, Estimate]) -> str:
    """Write the modulus of c1 + i c2."""
    modulus = Estimate.modulus(*c)
    return f"{modulus.value:.4f} ± {modulus.error or 0.0:.4f}"
