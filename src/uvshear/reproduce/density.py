"""Target ``density``: slopes against the number density of galaxies (section 4.2)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.crowded_field import EXTRACTIONS, CrowdedField
from uvshear.reproduce.density_curves import Series, curves_of_density
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.reproduce.shape_sample import ShapeSample, sample_named
from uvshear.typing import Array

WHOLE = "whole"
"""Beginning of the name of the part that has the whole field of the paper."""

PAPER_DENSITY = 2.8
"""Density at which the paper states its slopes [galaxies per square arcminute]."""


@dataclass(frozen=True)
class DensityTarget(PaperTarget):
    """Slopes of galaxies that are measured together in one field, at several densities.

    Parameters
    ----------
    densities
        Numbers of galaxies per square arcminute.
    galaxies
        Number of galaxies in a field.
    fields
        Number of fields at each density.
    integration
        Length of a sample [s].
    whole
        Number of galaxies in the field that is measured in the paper's way with the paper's number of samples.
    whole_integration
        Length of a sample of that field [s].
    """

    name = "density"
    title = "Slopes against the density of galaxies"

    densities: tuple[float, ...] = (0.5, 1.0, 2.0, PAPER_DENSITY, 5.0, 8.0)
    galaxies: int = 1000
    fields: int = 10
    integration: float = 900.0
    whole: int = 10080
    whole_integration: float = 60.0

    def tasks(self) -> Mapping[str, CrowdedField]:
        """Return the field of the paper, and the others, each of which is measured in two ways."""
        pointing = PaperPointing(integration=self.whole_integration)
        # The whole field takes as long as several others together, and comes first.
        whole = CrowdedField(
            "paper", pointing, self.whole, PAPER_DENSITY, 1, 1000 * self.seed + self.fields
        )
        pointing = PaperPointing(integration=self.integration)
        return {f"{WHOLE}-0": whole} | {
            f"{way}-{density:g}-{field}": CrowdedField(
                way, pointing, self.galaxies, density, 1, 1000 * self.seed + field
            )
            for density in self.densities
            for way in EXTRACTIONS
            for field in range(self.fields)
        }

    def measure(self, task: CrowdedField) -> Mapping[str, Array]:
        """Simulate and measure a field."""
        return task.measured()

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare slopes and bad measurements at each density."""
        printed = PublishedFigures.read(self.name)
        quantities: list[Quantity] = []
        series: Series = {way: [] for way in EXTRACTIONS}
        for density in self.densities:
            samples = {way: sample_named(found, f"{way}-{density:g}") for way in EXTRACTIONS}
            for way, sample in samples.items():
                first, second = (
                    Estimate.from_slope(slopes.inverse_variance) for slopes in sample.slopes()
                )
                series[way].append((first, second))
            is_printed = density == PAPER_DENSITY
            for part in (0, 1):
                quantities.append(
                    Quantity(
                        f"slope of e{part + 1} at {density:g} per arcmin²",
                        printed.estimate(f"slope_e{part + 1}") if is_printed else None,
                        series["paper"][-1][part],
                        series["converged"][-1][part],
                    )
                )
            quantities.append(
                Quantity(
                    f"bad measurements at {density:g} per arcmin² [%]",
                    printed.estimate("bad_percent") if is_printed else None,
                    _bad_percent(samples["paper"]),
                    _bad_percent(samples["converged"]),
                )
            )
        quantities += self._whole_field(found, printed)
        panels = []
        for part in (0, 1):
            published = printed.estimate(f"slope_e{part + 1}")
            curves = [
                Curve(
                    "Rivi & Miller 2018",
                    [PAPER_DENSITY],
                    [published.value],
                    [published.error or 0.0],
                    is_published=True,
                    is_line=False,
                )
            ]
            curves += curves_of_density(self.densities, series, part)
            panels.append(
                CurvePanel(
                    "galaxies per square arcminute",
                    f"slope of $e_{part + 1}$",
                    tuple(curves),
                    levels=(1.0,),
                )
            )
        caption = (
            "Slopes of measured on true ellipticity, with weights 1/s² (s: error), of galaxies that are measured"
            " together in one field, against their number density."
        )
        width = (self.galaxies / PAPER_DENSITY) ** 0.5
        remarks = (
            f"Each density has {self.fields} fields of {self.galaxies} galaxies, in samples of {self.integration:g} s;"
            f" at a density of {PAPER_DENSITY:g} such a field is {width:.0f} arcmin wide. The last rows are for one"
            f" field of {self.whole} galaxies with the same density as the paper's, {PAPER_DENSITY:g} per square"
            " arcminute. In all fields a galaxy of 10 µJy and of median size has a signal-to-noise ratio of 10. Bad"
            " measurements are fits that failed; those of the paper are fits with too small an error.",
        )
        return Finding(tuple(quantities), draw_curves(panels), caption, remarks)

    def _whole_field(
        self, found: Mapping[str, Mapping[str, Array]], printed: PublishedFigures
    ) -> list[Quantity]:
        """Compare the slopes of the field that has the paper's number of galaxies and of samples."""
        sample = sample_named(found, WHOLE)
        words = f"{self.whole} galaxies in one field, samples of {self.whole_integration:g} s"
        rows = [
            Quantity(
                f"slope of e{part + 1}, {words}",
                printed.estimate(f"slope_e{part + 1}"),
                Estimate.from_slope(slopes.inverse_variance),
            )
            for part, slopes in enumerate(sample.slopes())
        ]
        bad = Quantity(
            f"bad measurements, {words} [%]",
            printed.estimate("bad_percent"),
            _bad_percent(sample),
        )
        return [*rows, bad]


def _bad_percent(sample: ShapeSample) -> Estimate:
    """Return the percentage of fits that have failed."""
    bad = int(np.sum(~sample.is_good))
    return Estimate(100 * bad / len(sample), 100 * max(bad, 1) ** 0.5 / len(sample))
