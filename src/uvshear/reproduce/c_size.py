"""Target ``c-size``: additive bias against the size of the galaxies at one signal-to-noise ratio (section 6)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from uvshear.constants import MICROJANSKY
from uvshear.galaxy import PowerLawFlux, SizeFluxRelation
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.additive_bias import PAIRED, AdditiveBiasTarget, additive_bias
from uvshear.reproduce.facet_ways import ExactFacetWay
from uvshear.reproduce.finding import Finding, Quantity, signed
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.simulation.population import Population
from uvshear.typing import Array

ALIKE = PowerLawFlux(minimum=20 * MICROJANSKY, maximum=20.002 * MICROJANSKY)
"""Fluxes of galaxies of one size."""

SNR = 20.0
"""Signal-to-noise ratio of galaxies of one size."""


@dataclass(frozen=True)
class SizeBias(AdditiveBiasTarget):
    """Additive bias of galaxies of one size each, and of the paper's two ways to a signal-to-noise ratio of 25.

    Parameters
    ----------
    distance
        Distance of the transit from the zenith [deg].
    sizes
        Median scale lengths [arcsec].
    """

    name = "c-size"
    title = "Additive bias and the size of galaxies"

    distance: float = 40.0
    sizes: tuple[float, ...] = (0.6, 1.0, 1.6, 2.5)

    def cases(self) -> Mapping[str, MockSurvey]:
        """Return surveys of one size each, one with a high flux and one with little noise."""
        pointing = PaperPointing.from_zenith(math.radians(self.distance), self.integration)
        way = ExactFacetWay()
        bright = Population(flux=PowerLawFlux(minimum=25 * MICROJANSKY))
        found = {
            "flux": MockSurvey(way, pointing, population=bright, seed=self.seed),
            "noise": MockSurvey(way, pointing, snr=25.0, seed=self.seed),
        }
        for size in self.sizes:
            relation = SizeFluxRelation(intercept=math.log(size), slope=0.0)
            found[f"size-{size:g}"] = MockSurvey(
                way,
                pointing,
                population=Population(flux=ALIKE, size=relation),
                flux=ALIKE.minimum,
                snr=SNR,
                seed=self.seed,
            )
        return found

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare c of small and of large galaxies."""
        words = {
            "flux": "SNR ≥ 25 by a cut of the flux at 25 µJy",
            "noise": "SNR ≥ 25 by less noise, fluxes from 10 µJy on",
        }
        biases = {case: additive_bias(found, case) for case in self.cases()}
        quantities = [
            Quantity(f"c{part + 1} at {self.distance:g} deg, {words[case]}", own=biases[case][part])
            for case in words
            for part in (0, 1)
        ]
        quantities += [
            Quantity(
                f"c{part + 1} at {self.distance:g} deg, SNR {SNR:g}, scale length {size:g} arcsec",
                own=biases[f"size-{size:g}"][part],
            )
            for size in self.sizes
            for part in (0, 1)
        ]
        series = [biases[f"size-{size:g}"] for size in self.sizes]
        panel = CurvePanel(
            "median scale length [arcsec]",
            "additive bias",
            tuple(
                Curve(
                    f"$c_{part + 1}$",
                    list(self.sizes),
                    [both[part].value for both in series],
                    [both[part].error or 0.0 for both in series],
                )
                for part in (0, 1)
            ),
            levels=(0.0,),
            is_log=True,
            ticks=self.sizes,
        )
        caption = (
            f"Additive bias of the mean of isolated galaxies with a signal-to-noise ratio of {SNR:g} against their"
            f" median scale length, {self.distance:g} deg from the zenith; exact facets."
        )
        by_flux, by_noise = biases["flux"][0], biases["noise"][0]
        small = [abs(both[0].value) for both in series]
        remark = (
            f"There are {self.galaxies} galaxies in each case. Between the two ways to an SNR of 25, c1 differs by"
            f" {signed(by_noise.value - by_flux.value)} ±"
            f" {math.hypot(by_noise.error or 0.0, by_flux.error or 0.0):.4f}. At an SNR of {SNR:g} the modulus of c1"
            f" is {small[0]:.4f} for the smallest and {small[-1]:.4f} for the largest galaxies."
        )
        return Finding(tuple(quantities), draw_curves([panel]), caption, (PAIRED, remark))
