"""Target ``metacal-round``: metacalibration with an isotropic PSF (section 5)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from uvshear.bias import opposite_shears
from uvshear.bias.fit import TermSums, fit_bias
from uvshear.bias.isolated import sum_terms
from uvshear.estimators import Bias, Estimator, Mean, Metacal
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.facet_ways import ExactFacetWay, FacetWay, RoundCoverage
from uvshear.reproduce.finding import Estimate, Finding, Quantity, signed
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import BASELINE, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.simulation.lensing import shear_galaxies
from uvshear.typing import Array

SHEARS = opposite_shears(0.03)
"""Shears in the frame of the sky; those in the frame of (l, m) have the other sign of the second component."""


@dataclass(frozen=True)
class MetacalCase:
    """An estimator and the facets to which it is applied.

    Parameters
    ----------
    words
        Name for the reader.
    estimator
        The estimator.
    facets
        Way to make facets.
    """

    words: str
    estimator: Estimator
    facets: FacetWay


CASES: Mapping[str, MetacalCase] = {
    "mean": MetacalCase("of the mean", Mean(), ExactFacetWay()),
    "metacal": MetacalCase("with metacalibration", Metacal(), ExactFacetWay()),
    "experiment": MetacalCase(
        "with metacalibration, experiment: round uv coverage", Metacal(), RoundCoverage()
    ),
}


@dataclass(frozen=True)
class MetacalTask:
    """Galaxies that are measured together in one case.

    Parameters
    ----------
    case
        Name of the case.
    first, number
        Number of the first galaxy, and number of galaxies.
    """

    case: str
    first: int
    number: int


@dataclass(frozen=True)
class MetacalRound(PaperTarget):
    """Bias of the mean, and of the mean with metacalibration, which has a round PSF.

    Parameters
    ----------
    pointing
        The observation.
    galaxies, block
        Number of galaxies, each of which is measured four times with both shears, and in a part.
    """

    name = "metacal-round"
    title = "Metacalibration with an isotropic PSF"

    pointing: PaperPointing = BASELINE
    galaxies: int = 600
    block: int = 20

    def tasks(self) -> Mapping[str, MetacalTask]:
        """Return blocks of galaxies for each case."""
        return {
            f"{name}-{first}": MetacalTask(name, first, min(self.block, self.galaxies - first))
            for name in CASES
            for first in range(0, self.galaxies, self.block)
        }

    def measure(self, task: MetacalTask) -> Mapping[str, Array]:
        """Sum the terms of the case's estimator over a block of galaxies."""
        case = CASES[task.case]
        survey = MockSurvey(
            case.facets,
            self.pointing,
            shears=tuple(shear.conjugate() for shear in SHEARS),
            lens=shear_galaxies,
            seed=self.seed,
        )
        sums = sum_terms(
            survey.experiment(),
            case.estimator,
            [0j] * len(SHEARS),
            task.first,
            task.number,
        )
        return {"values": sums.values, "count": sums.count, "failed": sums.failed}

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare m and c of both estimators, in total and by flux, and c in the experiment."""
        biases = {name: _bias(found, name) for name in CASES}
        quantities = []
        for name, bias in biases.items():
            for part in (bias, *bias.bins):
                words = "all" if part.name == "all" else part.name.replace("uJy", "µJy")
                for k in (0, 1):
                    # The second component changes its sign between the frames of the sky and of (l, m).
                    sign = (1, -1)[k]
                    quantities += [
                        Quantity(
                            f"m{k + 1} {CASES[name].words}, {words}",
                            own=Estimate(float(part.m[k]), float(part.m_err[k])),
                        ),
                        Quantity(
                            f"c{k + 1} {CASES[name].words}, {words}",
                            own=Estimate(sign * float(part.c[k]), float(part.c_err[k])),
                        ),
                    ]
        panels = [
            CurvePanel(
                "flux density [µJy]",
                f"multiplicative bias $m_{k + 1}$",
                tuple(
                    Curve(
                        name.replace("metacal", "metacalibration"),
                        [float(place) for place in range(len(bias.bins))],
                        [float(part.m[k]) for part in bias.bins],
                        [float(part.m_err[k]) for part in bias.bins],
                    )
                    for name, bias in biases.items()
                    if name != "experiment"
                ),
                levels=(0.0,),
                names=tuple(part.name.removesuffix(" uJy") for part in biases["mean"].bins),
            )
            for k in (0, 1)
        ]
        caption = (
            "Multiplicative bias of the mean, and of the mean with metacalibration, which has a round PSF, by flux of"
            " the galaxies."
        )
        metacal, experiment = (
            " and ".join(
                f"c{k + 1} = {signed((1, -1)[k] * float(biases[name].c[k]))} ± {float(biases[name].c_err[k]):.4f}"
                for k in (0, 1)
            )
            for name in ("metacal", "experiment")
        )
        remarks = (
            f"{self.galaxies} galaxies with an SNR of 10 or more are measured with e and −e, and with a realisation of"
            " the noise and its negative, with input shears of modulus 0.03 and both signs, which change sizes as a"
            " lens does. The mean has natural weights. A part in a thousand could be tested only with far more"
            " galaxies.",
            f"With metacalibration, {metacal}, although its PSF is round: where the uv plane has little power P, data"
            " that are made to have a round PSF G have noise of the variance G²/P, which is not round. In an"
            " experiment we replace P by its means over rings of the uv plane, so that the noise is round too; then"
            f" {experiment}.",
        )
        return Finding(tuple(quantities), draw_curves(panels), caption, remarks)


def _bias(found: Mapping[str, Mapping[str, Array]], name: str) -> Bias:
    blocks = [part for key, part in found.items() if key.rpartition("-")[0] == name]
    values = np.array([block["values"] for block in blocks])
    count, failed = (
        np.sum([block[what] for block in blocks], axis=0).astype(int)
        for what in ("count", "failed")
    )
    total = TermSums(values.sum(axis=1), int(count.sum()), int(failed.sum()))
    bins = {
        flux_bin.name: TermSums(values[:, k], int(count[k]), int(failed[k]))
        for k, flux_bin in enumerate(FLUX_BINS)
    }
    return fit_bias(total, bins, SHEARS, [0j] * len(SHEARS))
