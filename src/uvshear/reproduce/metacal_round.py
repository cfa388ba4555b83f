"""Target ``metacal-round``: metacalibration behind an isotropic PSF (section 5)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from uvshear.bias import opposite_shears
from uvshear.bias.fit import TermSums, fit_bias
from uvshear.bias.isolated import sum_terms
from uvshear.estimators import Bias, Estimator, Mean, Metacal
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.facet_ways import ExactFacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import BASELINE, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.simulation.lensing import shear_galaxies
from uvshear.typing import Array

SHEARS = opposite_shears(0.03)
"""Shears in the frame of the sky; those in the frame of (l, m) have the other sign of the second component."""

ESTIMATORS: Mapping[str, Estimator] = {"mean": Mean(), "metacal": Metacal()}


@dataclass(frozen=True)
class MetacalTask:
    """Galaxies that are measured together with one estimator.

    Parameters
    ----------
    estimator
        Name of the estimator.
    first, number
        Number of the first galaxy, and number of galaxies.
    """

    estimator: str
    first: int
    number: int


@dataclass(frozen=True)
class MetacalRound(PaperTarget):
    """Bias of the mean, and of the mean with metacalibration behind a round PSF.

    Parameters
    ----------
    pointing
        The observation.
    galaxies, block
        Number of galaxies, each of which is measured four times behind both shears, and in a part.
    """

    name = "metacal-round"
    title = "Metacalibration behind an isotropic PSF"

    pointing: PaperPointing = BASELINE
    galaxies: int = 600
    block: int = 20

    def tasks(self) -> Mapping[str, MetacalTask]:
        """Return blocks of galaxies for each estimator."""
        return {
            f"{name}-{first}": MetacalTask(name, first, min(self.block, self.galaxies - first))
            for name in ESTIMATORS
            for first in range(0, self.galaxies, self.block)
        }

    def measure(self, task: MetacalTask) -> Mapping[str, Array]:
        """Sum the terms of the estimator over a block of galaxies."""
        survey = MockSurvey(
            ExactFacetWay(),
            self.pointing,
            shears=tuple(shear.conjugate() for shear in SHEARS),
            lens=shear_galaxies,
            seed=self.seed,
        )
        sums = sum_terms(
            survey.experiment(),
            ESTIMATORS[task.estimator],
            [0j] * len(SHEARS),
            task.first,
            task.number,
        )
        return {"values": sums.values, "count": sums.count, "failed": sums.failed}

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare m and c of both estimators, in total and by flux."""
        biases = {name: _bias(found, name) for name in ESTIMATORS}
        quantities = []
        for name, bias in biases.items():
            for part in (bias, *bias.bins):
                words = "all" if part.name == "all" else part.name.replace("uJy", "µJy")
                for k in (0, 1):
                    # The second component changes its sign between the frames of the sky and of (l, m).
                    sign = (1, -1)[k]
                    quantities += [
                        Quantity(
                            f"m{k + 1} of {name}, {words}",
                            own=Estimate(float(part.m[k]), float(part.m_err[k])),
                        ),
                        Quantity(
                            f"c{k + 1} of {name}, {words}",
                            own=Estimate(sign * float(part.c[k]), float(part.c_err[k])),
                        ),
                    ]
        panels = [
            CurvePanel(
                "flux density [µJy]",
                f"multiplicative bias $m_{k + 1}$",
                tuple(
                    Curve(
                        name,
                        [float(place) for place in range(len(bias.bins))],
                        [float(part.m[k]) for part in bias.bins],
                        [float(part.m_err[k]) for part in bias.bins],
                    )
                    for name, bias in biases.items()
                ),
                levels=(0.0,),
                names=tuple(part.name.removesuffix(" uJy") for part in biases["mean"].bins),
            )
            for k in (0, 1)
        ]
        caption = "Multiplicative bias of the mean, and of the mean with metacalibration behind a round PSF, by flux."
        remarks = (
            f"{self.galaxies} galaxies with an SNR of 10 or more are measured with e and −e, and with a realisation of"
            " the noise and its negative, behind opposite shears of modulus 0.03 that change sizes as a lens does.",
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
