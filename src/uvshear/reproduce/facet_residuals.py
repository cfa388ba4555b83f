"""Target ``facet-residuals``: residuals of ellipticities with facets of fixed and of variable size (section 4.1)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from uvshear.constants import MICROJANSKY
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.cell_counts import FixedCount, TableCount
from uvshear.reproduce.facet_ways import CellFacets, ExactFacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import BASELINE, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.reproduce.shape_sample import (
    FLAGS,
    ShapeSample,
    ShapeTask,
    measure_shapes,
    sample_named,
    shape_tasks,
)
from uvshear.shapes.measurement import FitFlag
from uvshear.typing import Array

WAYS = {
    "fixed": CellFacets(FixedCount(600)),
    "variable": CellFacets(TableCount()),
    "exact": ExactFacetWay(),
}
"""Ways to make the facets of the same galaxies."""

WORDS = {
    "fixed": "facets of 600² cells",
    "variable": "facets of Table 1",
    "exact": "exact facets",
}

EDGES = np.linspace(-0.8, 0.8, 9)
"""Edges of the bins of the true ellipticity."""

BLOCK = 50
"""Number of galaxies in a part."""

FAINT = 25 * MICROJANSKY
"""Flux below which measurements are taken for bad in the experiment [Jy]."""

TOO_SMALL = 3.0
"""Factor by which the errors of bad measurements are too small in the experiment."""

DRAWS = 200
"""Number of choices of the bad measurements in the experiment."""


@dataclass(frozen=True)
class FacetResiduals(PaperTarget):
    """Residuals of the ellipticities of isolated galaxies of all fluxes.

    Parameters
    ----------
    pointing
        The observation.
    galaxies
        Number of galaxies.
    """

    name = "facet-residuals"
    title = "Residuals with facets of fixed and of variable size"

    pointing: PaperPointing = BASELINE
    galaxies: int = 1000

    def tasks(self) -> Mapping[str, ShapeTask]:
        """Return blocks of galaxies for each kind of facet."""
        found: dict[str, ShapeTask] = {}
        for name, way in WAYS.items():
            survey = MockSurvey(way, self.pointing, seed=self.seed)
            found |= shape_tasks(name, survey, self.galaxies, BLOCK)
        return found

    def measure(self, task: ShapeTask) -> Mapping[str, Array]:
        """Measure the shapes of a block of galaxies."""
        return measure_shapes(task)

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare slopes, bad measurements and residuals."""
        printed = PublishedFigures.read(self.name)
        samples = {name: sample_named(found, name) for name in WAYS}
        exact = samples["exact"].slopes()
        quantities = []
        for name in ("fixed", "variable"):
            slopes = samples[name].slopes()
            for part in (0, 1):
                quantities.append(
                    Quantity(
                        f"slope of e{part + 1}, {WORDS[name]}",
                        printed.estimate(f"slope_{name}_e{part + 1}"),
                        Estimate.from_slope(slopes[part].inverse_variance),
                        Estimate.from_slope(exact[part].inverse_variance),
                    )
                )
        for name in ("fixed", "variable"):
            quantities.append(
                Quantity(
                    f"bad measurements of 1000, {WORDS[name]}",
                    printed.estimate(f"bad_{name}"),
                    self._bad(samples[name]),
                    self._bad(samples["exact"]),
                )
            )
        quantities += self._slopes_with_bad_ones(samples, printed)
        formal = samples["variable"].slopes()[0].inverse_variance.formal_error
        quantities.append(
            Quantity(
                "error of the slope of e1 by the errors of 1000 galaxies alone, facets of Table 1",
                Estimate(printed.estimate("slope_variable_e1").error or 0.0),
                Estimate(formal * (self.galaxies / 1000) ** 0.5),
            )
        )
        panels = [
            CurvePanel(
                "true $e_1$",
                "mean of measured - true $e_1$",
                tuple(_residuals(samples[way], WORDS[way]) for way in (name, "exact")),
                title,
                levels=(0.0,),
            )
            for name, title in (("fixed", "600 x 600"), ("variable", "variable size"))
        ]
        caption = (
            "Means of measured minus true e1 in bins of the true e1, with weights 1/s² (s: error), for isolated"
            " galaxies of 10 to 200 µJy: with facets of 600² cells (left) and with those of Table 1 (right), each"
            " beside exact facets."
        )
        return Finding(
            tuple(quantities),
            draw_curves(panels, has_common_y=True),
            caption,
            self._remarks(samples),
        )

    def _bad(self, sample: ShapeSample) -> Estimate:
        """Return the number of bad measurements, scaled to 1000 galaxies."""
        bad = int(np.sum(~sample.is_good))
        scale = 1000 / len(sample)
        return Estimate(bad * scale, max(bad, 1) ** 0.5 * scale)

    def _slopes_with_bad_ones(
        self, samples: Mapping[str, ShapeSample], printed: PublishedFigures
    ) -> list[Quantity]:
        """Return the slopes if as many measurements were bad as in the paper, and were not left out."""
        rows = []
        for name in ("fixed", "variable"):
            bad = printed.estimate(f"bad_{name}").value
            number = round(bad * len(samples[name]) / 1000)
            found = slopes_with_bad_ones(samples[name], number, np.random.default_rng(self.seed))
            for part, slope in enumerate(found):
                printed_slope = printed.estimate(f"slope_{name}_e{part + 1}")
                words = f"slope of e{part + 1}, {WORDS[name]}, experiment: {bad:g} of 1000 bad"
                rows.append(Quantity(words, printed_slope, slope))
        return rows

    def _remarks(self, samples: Mapping[str, ShapeSample]) -> tuple[str, ...]:
        pairs = {
            name: " and ".join(
                f"{each.inverse_variance.value:.3f}" for each in samples[name].slopes()
            )
            for name in ("fixed", "variable")
        }
        flags = [self._flags(name, sample) for name, sample in samples.items()]
        return (
            f"There are {self.galaxies} galaxies of 10 to 200 µJy, the same for all facets, at the phase centre; those"
            " of the paper are anywhere in the field. A galaxy of 10 µJy and of median size has an SNR of 10. The noise"
            " is independent for each kind of facets; in the paper it is the same.",
            " ".join(filter(None, flags)) or "No fit failed.",
            f"With facets of 600² cells the slopes of e1 and e2 are {pairs['fixed']}, and with those of Table 1"
            f" {pairs['variable']}; in the paper those with 600² cells are the smaller ones. The paper describes bad"
            " measurements as those with too small an error. An experiment shows what such measurements can do if they"
            f" are not recognised: from our galaxies below {FAINT / MICROJANSKY:g} µJy we take as many as the paper has"
            " bad measurements, exchange their measured ellipticities at random, and divide their errors by"
            f" {TOO_SMALL:g}. They take weight from the others, which lowers the slopes to those in the rows of the"
            " experiment. The limit of the flux and the factor are our choices, the same for all four slopes. The"
            " numbers of bad measurements are those of the paper; the experiment does not explain them.",
        )

    def _flags(self, name: str, sample: ShapeSample) -> str:
        """Say which fits failed with one kind of facets; nothing if none did."""
        counts = np.bincount(sample.flag, minlength=len(FLAGS))
        told = [
            f"{number} {flag.word}"
            for flag, number in zip(FLAGS, counts.tolist(), strict=True)
            if number and flag is not FitFlag.OK
        ]
        return f"Flags with {WORDS[name]}: {', '.join(told)}." if told else ""


def slopes_with_bad_ones(
    sample: ShapeSample, number: int, rng: np.random.Generator
) -> tuple[Estimate, Estimate]:
    """Return the slopes of e1 and e2 if some of the faint galaxies had others' ellipticities and too small errors.

    The slopes are means over ``DRAWS`` choices of these galaxies. Their errors contain the scatter among the choices.
    """
    good = sample.select(sample.is_good)
    faint = np.flatnonzero(good.flux < FAINT)
    drawn = []
    for _ in range(DRAWS):
        bad = rng.choice(faint, min(number, len(faint)), replace=False)
        measured, error = good.measured.copy(), good.error.copy()
        measured[bad] = measured[rng.permutation(bad)]
        error[bad] /= TOO_SMALL
        spoilt = replace(good, measured=measured, error=error)
        drawn.append([each.inverse_variance.value for each in spoilt.slopes()])
    alone = [each.inverse_variance.error for each in good.slopes()]
    first, second = (
        Estimate(float(mean), math.hypot(float(scatter), error))
        for mean, scatter, error in zip(
            np.mean(drawn, axis=0), np.std(drawn, axis=0), alone, strict=True
        )
    )
    return first, second


def _residuals(sample: ShapeSample, label: str) -> Curve:
    """Return weighted means of measured minus true e1 in bins of the true e1."""
    good = sample.select(sample.is_good)
    true, difference = good.true.real, (good.measured - good.true).real
    weight = good.error[:, 0] ** -2
    place = np.digitize(true, EDGES) - 1
    x, y, error = [], [], []
    for k in range(len(EDGES) - 1):
        inside = place == k
        if inside.sum() < 2:
            continue
        total = float(weight[inside].sum())
        mean = float((weight * difference)[inside].sum()) / total
        x.append(float((weight * true)[inside].sum()) / total)
        y.append(mean)
        error.append(float(np.sqrt(((weight * (difference - mean))[inside] ** 2).sum())) / total)
    return Curve(label, x, y, error)
