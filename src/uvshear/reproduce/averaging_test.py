"""Target ``averaging``: samples of 30 kHz and 0.5 s that are averaged into a single uv grid (section 2.1)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from uvshear.bias.isolated import FITTED
from uvshear.constants import REFERENCE_FREQUENCY, SPECTRAL_INDEX
from uvshear.diagnostics.slope import Slope, fit_slope
from uvshear.plot.curves import draw_curves
from uvshear.reproduce.cell_counts import TableCount
from uvshear.reproduce.finding import Estimate, Finding, Quantity, signed
from uvshear.reproduce.paper_pointing import BAND, BASELINE, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.random_samples import RandomSamples, Resolution
from uvshear.reproduce.slope_panel import slope_panel
from uvshear.reproduce.true_galaxies import TrueGalaxies, blocks_of_galaxies
from uvshear.reproduce.visibility_cells import VisibilityCells
from uvshear.shapes.measurement import FitFlag
from uvshear.shapes.shape import measure_shape
from uvshear.shapes.template import Template
from uvshear.simulation.population import Population
from uvshear.typing import Array

SNR = 100.0
"""Signal-to-noise ratio that the likelihood assumes for every galaxy; the data have no noise."""


@dataclass(frozen=True)
class SamplingCase:
    """A sampling of the visibilities.

    Parameters
    ----------
    words
        Description for the reader.
    resolution
        Channels and integrations; their smearing is part of the data and not of the model.
    is_smeared
        Whether samples are averages; otherwise each is at the middle of its channel and integration.
    spectral_index
        Spectral index of the galaxies; the model has 0 within the band.
    widening
        Factor of the number of cells along a side.
    """

    words: str
    resolution: Resolution
    is_smeared: bool = True
    spectral_index: float = SPECTRAL_INDEX
    widening: float = 1.0


FINE = Resolution(30e3, 0.5)

WIDENING = 2 * BAND[1] / (BAND[0] + BAND[1])
"""Longest baseline of the band over that in its middle, both in wavelengths."""

CASES: Mapping[str, SamplingCase] = {
    "paper": SamplingCase(
        "one channel and 60 s, not smeared", Resolution(BAND[1] - BAND[0], 60.0), False
    ),
    "fine": SamplingCase("30 kHz and 0.5 s", FINE),
    "medium": SamplingCase("100 kHz and 2 s", Resolution(100e3, 2.0)),
    "coarse": SamplingCase("1 MHz and 8 s", Resolution(1e6, 8.0)),
    "unsmeared": SamplingCase("30 kHz and 0.5 s, experiment: not smeared", FINE, False),
    "flat": SamplingCase(
        "30 kHz and 0.5 s, experiment: spectral index 0", FINE, spectral_index=0.0
    ),
    "wide": SamplingCase(
        "30 kHz and 0.5 s, experiment: facets as wide as with one channel", FINE, widening=WIDENING
    ),
}
"""What is compared; the experiments see the samples of the second case."""


@dataclass(frozen=True)
class AveragingTest(PaperTarget):
    """Shapes from cells in which samples of a wide band are averaged, anywhere in the square degree.

    Parameters
    ----------
    pointing
        The observation.
    galaxies, block
        Number of galaxies, and in a part.
    samples
        Number of samples that are drawn for each galaxy.
    half_width
        Half of the width of the field [rad].
    """

    name = "averaging"
    title = "Averages of narrow channels and short integrations"

    pointing: PaperPointing = BASELINE
    galaxies: int = 300
    block: int = 10
    samples: int = 600_000
    half_width: float = math.radians(0.5)

    def tasks(self) -> Mapping[str, tuple[int, int]]:
        """Return the first galaxy and the number of galaxies of each part."""
        return blocks_of_galaxies(self.galaxies, self.block)

    def measure(self, task: tuple[int, int]) -> Mapping[str, Array]:
        """Measure every galaxy in every case: e1, e2, their errors, and whether the fit is good."""
        first, number = task
        rng = np.random.default_rng([self.seed, first])
        true = TrueGalaxies.draw(Population(), number, rng)
        directions = rng.uniform(-self.half_width, self.half_width, (number, 2))
        drawn = {
            resolution: RandomSamples.draw(self.pointing, resolution, self.samples, rng)
            for resolution in dict.fromkeys(case.resolution for case in CASES.values())
        }
        measured = np.full((number, len(CASES), 5), np.nan)
        for k in range(number):
            galaxy = true.galaxy(k)
            prior = true.prior(k)
            count = TableCount().cells(math.exp(prior.log_scale_length))
            for way, case in enumerate(CASES.values()):
                samples = drawn[case.resolution]
                l, m = directions[k].tolist()
                visibilities = Template(samples.uv_from(l, m), FITTED).model(galaxy)
                middle = (samples.frequency / REFERENCE_FREQUENCY) ** case.spectral_index
                visibilities = visibilities * (middle / np.mean(middle))
                if case.is_smeared:
                    visibilities = visibilities * samples.kept(l, m)
                power = float(np.sum(np.abs(visibilities) ** 2))
                natural = np.full(len(visibilities), SNR**2 / power)
                cells = VisibilityCells(
                    samples.uv_from(l, m), natural, 2 * round(count * case.widening / 2)
                )
                shape = measure_shape(cells.natural_facet(visibilities), prior, FITTED)
                error = np.sqrt(np.diag(shape.covariance))
                measured[k, way] = (*shape.ellipticity, *error, shape.flag is FitFlag.OK)
        return {"true": true.ellipticity, "measured": measured}

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare the slopes of all cases."""
        true = np.concatenate([part["true"] for part in found.values()])
        measured = np.concatenate([part["measured"] for part in found.values()])
        good = np.all(measured[:, :, 4] == 1, axis=1)
        true, measured = true[good], measured[good]
        quantities = []
        drawn: dict[str, list[Slope]] = {}
        for way, case in enumerate(CASES.values()):
            slopes = [
                fit_slope(
                    (true.real, true.imag)[part], measured[:, way, part], measured[:, way, 2 + part]
                )
                for part in (0, 1)
            ]
            drawn[case.words] = slopes
            quantities += [
                Quantity(f"slope of e{part + 1}, {case.words}", None, Estimate.from_slope(slope))
                for part, slope in enumerate(slopes)
            ]
            if way > 0:
                change = measured[:, way, :2] - measured[:, 0, :2]
                quantities.append(
                    Quantity(
                        f"rms change of e from one channel and 60 s, {case.words}",
                        None,
                        Estimate(float(np.sqrt(np.mean(change**2)))),
                    )
                )
        caption = (
            "Slopes of measured on true ellipticity without noise, from averages in the cells of Table 1, for galaxies"
            " anywhere in a square degree."
        )
        remarks = (
            f"{len(true)} galaxies are seen in {self.samples} samples each, which are drawn at random from all"
            " baselines, integrations and channels of the band; the noise that the likelihood assumes is that of a"
            f" signal-to-noise ratio of {SNR:g}. Smearing within a sample is in the data and not in the model. The"
            " spectral index is −0.7 in the data and 0 within the band in the model.",
            f"Samples of 30 kHz and 0.5 s change the slopes of e1 and e2 by {_changes(drawn, 'paper', 'fine')} from"
            " those of one channel. Three experiments look for the reason. Without smearing the changes are"
            f" {_changes(drawn, 'paper', 'unsmeared')}, and with a spectral index of 0 they are"
            f" {_changes(drawn, 'paper', 'flat')}. The longest baseline, which sets the width of a cell, is"
            f" {100 * (WIDENING - 1):.0f} per cent longer in wavelengths than in the middle of the band: with as many"
            f" cells more along a side they are {_changes(drawn, 'paper', 'wide')}.",
        )
        return Finding(tuple(quantities), draw_curves([slope_panel(drawn)]), caption, remarks)


def _changes(drawn: Mapping[str, Sequence[Slope]], before: str, after: str) -> str:
    """Write the changes of both slopes between two cases."""
    pairs = zip(drawn[CASES[before].words], drawn[CASES[after].words], strict=True)
    return " and ".join(signed(second.value - first.value) for first, second in pairs)
