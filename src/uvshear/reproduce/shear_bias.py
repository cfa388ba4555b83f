"""Target ``shear-bias``: multiplicative and additive bias of the mean of isolated galaxies (Table 2)."""

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from uvshear.constants import MICROJANSKY
from uvshear.galaxy import PowerLawFlux
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.additive_bias import additive_bias
from uvshear.reproduce.causes_of_c import (
    MEASURED_CUT,
    ONE_REALISATION,
    TRACK_WORDS,
    causes_of_c,
)
from uvshear.reproduce.cell_counts import TableCount
from uvshear.reproduce.facet_ways import CellFacets, ExactFacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import (
    ABOUT_TRANSIT,
    BASELINE,
    FROM_TRANSIT,
    UNTIL_TRANSIT,
    PaperPointing,
)
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.reproduce.repeats import OppositePairs, Ring, TurnedPairs
from uvshear.reproduce.shape_sample import (
    ShapeSample,
    ShapeTask,
    measure_shapes,
    sample_named,
    shape_tasks,
)
from uvshear.reproduce.shear_statistics import MeanBias, mean_bias
from uvshear.typing import Array

WAYS = {"cells": CellFacets(TableCount()), "exact": ExactFacetWay()}

CUTS = {"10": 10 * MICROJANSKY, "25": 25 * MICROJANSKY}
"""Smallest flux [Jy] by the smallest signal-to-noise ratio. A galaxy of 10 µJy and of the median size has a ratio of
10, and the paper's 5810 of about 10⁴ galaxies above a ratio of 25 are those above 25 µJy for its distribution of
fluxes."""

TRACKS = {"about": ABOUT_TRANSIT, "later": FROM_TRANSIT, "earlier": UNTIL_TRANSIT}
"""Tracks of the parts without a shear, by the beginning of their names."""

SHEAR = 0.04
ORIENTATIONS = 8

SHEARS = tuple(
    cmath.rect(SHEAR, 2 * math.pi * k / ORIENTATIONS + math.pi / 8) for k in range(ORIENTATIONS)
)
"""Shears in the frame of (l, m); the paper does not state the directions."""


@dataclass(frozen=True)
class ShearBias(PaperTarget):
    """Bias of the mean ellipticity of isolated galaxies with eight shears.

    Parameters
    ----------
    pointing
        The observation.
    pairs
        Number of galaxies that are measured with e and -e, and noise and its negative.
    rings
        Number of rings of ten galaxies with one realisation of the noise, as in the paper.
    block
        Number of galaxies, or of rings, in a part.
    tracked
        Number of galaxies, without a shear, with each of three tracks.
    """

    name = "shear-bias"
    title = "Shear bias of isolated galaxies"

    pointing: PaperPointing = BASELINE
    pairs: int = 1000
    rings: int = 100
    block: int = 10
    tracked: int = 800

    def tasks(self) -> Mapping[str, ShapeTask]:
        """Return blocks of galaxies: pairs for both kinds of facets, rings for the paper's, and other tracks."""
        found: dict[str, ShapeTask] = {}
        for name, way in WAYS.items():
            survey = MockSurvey(way, self.pointing, shears=SHEARS, seed=self.seed)
            found |= shape_tasks(name, survey, self.pairs, self.block, OppositePairs())
            for track, times in TRACKS.items():
                survey = MockSurvey(way, replace(self.pointing, times=times), seed=self.seed)
                found |= shape_tasks(
                    f"{track}-{name}", survey, self.tracked, self.block, TurnedPairs()
                )
        survey = MockSurvey(WAYS["cells"], self.pointing, shears=SHEARS, seed=self.seed + 1)
        return found | dict(shape_tasks("rings", survey, self.rings, self.block, Ring()))

    def measure(self, task: ShapeTask) -> Mapping[str, Array]:
        """Measure the shapes of a block of galaxies."""
        return measure_shapes(task)

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare m and c with those of Table 2, and say what may make the paper's c."""
        printed = PublishedFigures.read(self.name)
        quantities: list[Quantity] = []
        biases: dict[str, dict[str, MeanBias]] = {}
        for cut, flux in CUTS.items():
            biases[cut] = {
                name: mean_bias(above(sample_named(found, name), flux), SHEARS)
                for name in (*WAYS, "rings")
            }
            for part in (0, 1):
                for what in ("m", "c"):
                    as_paper, own = (
                        getattr(biases[cut][name], what)[part] for name in ("cells", "exact")
                    )
                    quantities.append(
                        Quantity(
                            f"{what}{part + 1}, SNR ≥ {cut}, single source",
                            printed.estimate(f"{what}{part + 1}_snr{cut}"),
                            as_paper,
                            own,
                        )
                    )
        quantities.append(_bright_sources(printed))
        quantities += self._rows_of_rings(found, printed)
        for track in TRACKS:
            quantities += self._rows_of_track(found, printed, track)
        words = {"cells": "facets of Table 1", "exact": "exact facets"}
        panels = [shear_panel(cut, {words[way]: biases[cut][way] for way in WAYS}) for cut in CUTS]
        caption = (
            "Mean ellipticities with eight input shears of modulus 0.04 (crosses): the paper's facets and exact"
            " facets, for galaxies above a signal-to-noise ratio of 10 (left) and 25 (right)."
        )
        return Finding(tuple(quantities), draw_curves(panels), caption, self._remarks(quantities))

    def _rows_of_rings(
        self, found: Mapping[str, Mapping[str, Array]], printed: PublishedFigures
    ) -> list[Quantity]:
        """Compare c of one realisation of the noise, and c after a cut by the measured signal-to-noise ratio."""
        rings = sample_named(found, "rings")
        cuts = {
            ONE_REALISATION: rings,
            MEASURED_CUT: rings.select(rings.snr >= 10),
        }
        rows = []
        for words, sample in cuts.items():
            bias = mean_bias(sample, SHEARS)
            for part in (0, 1):
                name = f"c{part + 1}"
                rows.append(
                    Quantity(
                        f"{name}, SNR ≥ 10, {words}",
                        printed.estimate(f"{name}_snr10"),
                        bias.c[part],
                    )
                )
        return rows

    def _rows_of_track(
        self, found: Mapping[str, Mapping[str, Array]], printed: PublishedFigures, track: str
    ) -> list[Quantity]:
        """Compare c, and its modulus, without a shear."""
        rows = []
        for cut in CUTS:
            c = {way: additive_bias(found, f"{track}-{way}", float(cut)) for way in WAYS}
            in_print = (printed.estimate(f"c1_snr{cut}"), printed.estimate(f"c2_snr{cut}"))
            columns = (in_print, c["cells"], c["exact"])
            rows += rows_of_c(f"SNR ≥ {cut}, {TRACK_WORDS[track]}", *columns)
        return rows

    def _remarks(self, quantities: Sequence[Quantity]) -> tuple[str, ...]:
        return (
            "The cuts are those of the catalogue's flux, 10 and 25 µJy, at which a galaxy of median size has these"
            f" SNRs. {self.pairs} galaxies are measured with each shear, with e and −e, and with a realisation of the"
            " noise and its negative; the errors are those of these groups of four, in which shape noise cancels. For"
            f" the rows with rings, {self.rings} rings of ten galaxies have one realisation of the noise, which is the"
            " same with all shears. Shears change ellipticities and leave scale lengths alone, as in the paper. For the"
            f" rows of the tracks {self.tracked} galaxies are measured without a shear, eight times each: also rotated"
            " by 90 deg, together with their noise.",
            causes_of_c(quantities, self.rings),
            "The paper plots the ellipticity of its PSF against the zenith distance at the start of the observation,"
            " which suits a track that begins or ends at transit. The PSF of such a track, however, has an ellipticity"
            " of modulus 0.3 near the zenith (see `psf-zenith`), whereas the paper calls its PSF slightly anisotropic.",
        )


def _bright_sources(printed: PublishedFigures) -> Quantity:
    """Compare the number of sources above the higher cut, of which the paper states the number."""
    distribution = PowerLawFlux()
    flux = np.geomspace(CUTS["25"], distribution.maximum, 10_001)
    above_cut = float(np.trapezoid(distribution.density(flux), flux))
    return Quantity(
        "sources above 25 µJy, of 10⁴ with the paper's distribution of fluxes",
        printed.estimate("sources_snr25"),
        Estimate(float(round(1e4 * above_cut))),
    )


def rows_of_c(words: str, *columns: tuple[Estimate, Estimate]) -> list[Quantity]:
    """Return rows for c1, c2 and the modulus of c, with the numbers of the paper, of its way, and of this package."""
    parts = [
        Quantity(f"c{part + 1}, {words}", *(column[part] for column in columns)) for part in (0, 1)
    ]
    return [*parts, Quantity(f"modulus of c, {words}", *(Estimate.modulus(*c) for c in columns))]


def above(sample: ShapeSample, flux: float) -> ShapeSample:
    """Return the galaxies above a flux [Jy]."""
    return sample.select(sample.flux >= flux)


def shear_panel(cut: str, biases: Mapping[str, MeanBias]) -> CurvePanel:
    """Return a panel of the mean ellipticities of several biases, by their names, beside the input shears."""
    true = np.array(SHEARS)
    curves = [
        Curve(
            "input shear", true.real.tolist(), true.imag.tolist(), is_published=True, is_line=False
        )
    ]
    curves += [
        Curve(
            words,
            bias.shears.real.tolist(),
            bias.shears.imag.tolist(),
            bias.errors.imag.tolist(),
            bias.errors.real.tolist(),
            is_line=False,
        )
        for words, bias in biases.items()
    ]
    return CurvePanel(
        "$g_1$", "$g_2$", tuple(curves), f"SNR ≥ {cut}", levels=(0.0,), is_square=True
    )
