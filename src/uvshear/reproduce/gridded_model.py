"""Target ``gridded-model``: the model averaged in cells as the data are, too dear for the paper (section 4.1)."""

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from uvshear.bias.isolated import FITTED
from uvshear.diagnostics.slope import Slope, fit_slope
from uvshear.plot.curves import draw_curves
from uvshear.reproduce.cell_counts import TableCount
from uvshear.reproduce.cell_models import STEPS, AtPoints, Gridded, fit_cells
from uvshear.reproduce.facet_ways import ExactFacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import BASELINE, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.slope_panel import slope_panel
from uvshear.reproduce.true_galaxies import TrueGalaxies, blocks_of_galaxies
from uvshear.reproduce.visibility_cells import VisibilityCells
from uvshear.shapes.template import Template
from uvshear.typing import Array

WAYS = {
    "centres": "model at the centres of the cells",
    "means": "model at the mean baselines of the cells",
    "gridded": "model averaged as the data",
    "exact": "exact facets",
}
"""Models of the same galaxies, and exact facets."""


@dataclass(frozen=True)
class GriddedModel(PaperTarget):
    """Most likely ellipticities with models of increasing accuracy in the cells of Table 1.

    Parameters
    ----------
    pointing
        The observation.
    galaxies, block
        Number of galaxies, and in a part.
    snr
        Signal-to-noise ratio of a galaxy of 10 uJy and of median size.
    """

    name = "gridded-model"
    title = "The model averaged as the data"

    pointing: PaperPointing = BASELINE
    galaxies: int = 300
    block: int = 10
    snr: float = 100.0

    def tasks(self) -> Mapping[str, tuple[int, int]]:
        """Return the first galaxy and the number of galaxies of each part."""
        return blocks_of_galaxies(self.galaxies, self.block)

    def measure(self, task: tuple[int, int]) -> Mapping[str, Array]:
        """Fit every galaxy with every model: e1, e2, their errors and the processor time [s]."""
        first, number = task
        survey = MockSurvey(ExactFacetWay(), self.pointing, snr=self.snr, seed=self.seed)
        samples = survey.samples()
        beam = survey.experiment().beam
        uv, natural = samples.uv, samples.natural
        rng = np.random.default_rng([self.seed, first])
        true = TrueGalaxies.draw(survey.population, number, rng)
        fitted = np.full((number, len(WAYS), 5), np.nan)
        for k in range(number):
            galaxy = true.galaxy(k)
            prior = true.prior(k)
            noise = rng.standard_normal((2, len(uv)))
            visibilities = Template(uv, FITTED).model(galaxy).astype(complex)
            visibilities += (noise[0] + 1j * noise[1]) / np.sqrt(natural)
            cells = VisibilityCells(
                uv, natural, TableCount().cells(math.exp(true.size.log_median[k]))
            )
            data = cells.total(visibilities) / cells.weight
            simulator = beam.simulator(prior.log_scale_length, prior.log_scale_length_sigma)
            facet = simulator.facet(galaxy, FITTED, simulator.draw_noise(rng))
            inside = facet.power > 0
            power = facet.power[inside]
            problems = (
                (data, cells.weight, AtPoints(cells.centres)),
                (data, cells.weight, AtPoints(cells.means)),
                (data, cells.weight, Gridded(cells)),
                (facet.correlation[inside] / power, power, AtPoints(facet.uv[inside])),
            )
            for way, (mean, weight, model) in enumerate(problems):
                start = time.process_time()
                fit = fit_cells(mean, weight, model, prior, galaxy)
                spent = time.process_time() - start
                e_fit = fit.ellipticity
                fitted[k, way] = (e_fit.real, e_fit.imag, *fit.error, spent)
        return {"true": true.ellipticity, "fitted": fitted}

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare slopes, errors and times."""
        true = np.concatenate([part["true"] for part in found.values()])
        fitted = np.concatenate([part["fitted"] for part in found.values()])
        exact = fitted[:, list(WAYS).index("exact")]
        quantities: list[Quantity] = []
        drawn: dict[str, list[Slope]] = {}
        seconds: dict[str, float] = {}
        for way, (name, words) in enumerate(WAYS.items()):
            slopes = [
                fit_slope(
                    (true.real, true.imag)[part], fitted[:, way, part], fitted[:, way, 2 + part]
                )
                for part in (0, 1)
            ]
            drawn[words] = slopes
            values = {
                f"slope of e{part + 1}, {words}": Estimate.from_slope(slopes[part])
                for part in (0, 1)
            }
            if name != "exact":
                values[f"median error, divided by that of exact facets, {words}"] = Estimate(
                    float(np.median(fitted[:, way, 2:4] / exact[:, 2:4]))
                )
            seconds[name] = float(np.median(fitted[:, way, 4]))
            values[f"processor time of a fit in {STEPS} steps [s], {words}"] = Estimate(
                seconds[name]
            )
            quantities += [
                Quantity(row, own=estimate) if name == "exact" else Quantity(row, None, estimate)
                for row, estimate in values.items()
            ]
        caption = (
            "Slopes of measured on true ellipticity with the cells of Table 1 and three models, and with exact"
            " facets."
        )
        remarks = (
            f"The most likely ellipticities of {len(true)} galaxies of 10 to 200 µJy with a signal-to-noise ratio of"
            f" {self.snr:g} or more are compared; the fits begin at the true galaxy. The three models share the noise"
            f" of the visibilities. Each fit makes {STEPS} Gauss-Newton steps. The model averaged as the data takes"
            f" {seconds['gridded'] / seconds['centres']:.0f} times as long as that at the centres of the cells, for"
            f" samples of {self.pointing.integration:g} s; its time is proportional to the number of samples. The model"
            f" at the mean baselines takes {seconds['means'] / seconds['centres']:.1f} times as long.",
        )
        return Finding(tuple(quantities), draw_curves([slope_panel(drawn)]), caption, remarks)
