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
        End of the names of its rows.
    curve
        Its name in the picture.
    estimator
        The estimator.
    facets
        Way to make facets.
    """

    words: str
    curve: str
    estimator: Estimator
    facets: FacetWay


CASES: Mapping[str, MetacalCase] = {
    "mean": MetacalCase("of the mean", "mean", Mean(), ExactFacetWay()),
    "metacal": MetacalCase("with metacalibration", "metacalibration", Metacal(), ExactFacetWay()),
    "experiment": MetacalCase(
        "with metacalibration, experiment: round uv coverage",
        "experiment",
        Metacal(),
        RoundCoverage(),
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
                f"{word} bias ${what}_{k + 1}$",
                tuple(_curve(CASES[name].curve, biases[name], what, k) for name in shown),
                levels=(0.0,),
                names=("all", *(part.name.removesuffix(" uJy") for part in biases["mean"].bins)),
            )
            for what, word, shown in (
                ("m", "multiplicative", ("mean", "metacal")),
                ("c", "additive", tuple(CASES)),
            )
            for k in (0, 1)
        ]
        caption = (
            "Multiplicative bias (above) and additive bias (below) of the weighted mean of ellipticities, and of the"
            " same mean with metacalibration to a round PSF, for all galaxies and by flux. The experiment has a round"
            " coverage of the uv plane."
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
            " lens does. The mean has natural weights. The errors of m with metacalibration are"
            f" {float(biases['metacal'].m_err[0]):.2f} and {float(biases['metacal'].m_err[1]):.2f}, so that a part in a"
            " thousand could be tested only with far more galaxies.",
            f"With metacalibration, {metacal}, although its PSF is round: where the uv plane has little power P, data"
            " that are made to have a round PSF G have noise of the variance G²/P, which is not round. In an"
            " experiment we replace P by its means over rings of the uv plane, so that the noise is round too; then"
            f" {experiment}.",
        )
        return Finding(tuple(quantities), draw_curves(panels, rows=2), caption, remarks)


def _curve(label: str, bias: Bias, what: str, k: int) -> Curve:
    """Return m or c of all galaxies and of those in each bin of flux, in the frame of (l, m)."""
    parts = (bias, *bias.bins)
    # The second component of c changes its sign between the frames of the sky and of (l, m).
    sign = -1 if what == "c" and k == 1 else 1
    return Curve(
        label,
        [float(place) for place in range(len(parts))],
        [sign * float(getattr(part, what)[k]) for part in parts],
        [float(getattr(part, f"{what}_err")[k]) for part in parts],
    )


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
