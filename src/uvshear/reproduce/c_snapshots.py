"""Target ``c-snapshots``: the same integration time spread over other hour angles (section 6)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from uvshear.diagnostics.psf import point_spread_function
from uvshear.imaging import ImageGrid
from uvshear.interferometer.psf_shape import measure_psf
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.additive_bias import PAIRED, AdditiveBiasTarget, additive_bias
from uvshear.reproduce.facet_ways import ExactFacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity, signed
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import ABOUT_TRANSIT, FROM_TRANSIT, PaperPointing
from uvshear.reproduce.psf_zenith import COARSE_GRID, WEIGHT_SIGMA
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.typing import Array

HOUR = 3600.0

REQUIRED = 0.00082
"""Largest additive bias that a survey allows (section 5, footnote, after Brown et al. 2015)."""


def _snapshots(number: int, length: float, span: float) -> tuple[tuple[float, float], ...]:
    """Return equally spaced ranges of one length that fill a span about transit, all in hours."""
    step = (span - length) / (number - 1)
    starts = [-span / 2 + k * step for k in range(number)]
    return tuple((start * HOUR, (start + length) * HOUR) for start in starts)


TRACKS = {
    "8h": ABOUT_TRANSIT,
    "later": FROM_TRANSIT,
    "4x2h": _snapshots(4, 2.0, 12.0),
    "8x1h": _snapshots(8, 1.0, 12.0),
    "16x30m": _snapshots(16, 0.5, 12.0),
}
"""Ranges of clock time from transit [s]; each adds up to eight hours."""

AS_PAPER = ("8h", "later")
"""Tracks that the paper's may be: its text does not say where transit is."""

WORDS = {
    "8h": "8 h about transit",
    "later": "8 h from transit on",
    "4x2h": "4 x 2 h within 12 h",
    "8x1h": "8 x 1 h within 12 h",
    "16x30m": "16 x 30 min within 12 h",
}


@dataclass(frozen=True)
class SnapshotBias(AdditiveBiasTarget):
    """Ellipticity of the PSF and additive bias of tracks that add up to eight hours, at declination -30 deg.

    Parameters
    ----------
    grid
        Pixels of the image of the PSF.
    """

    name = "c-snapshots"
    title = "Additive bias of snapshots spread over hour angles"

    grid: ImageGrid = COARSE_GRID

    def cases(self) -> Mapping[str, MockSurvey]:
        """Return a survey for each track."""
        return {
            name: MockSurvey(ExactFacetWay(), self._pointing(name), seed=self.seed)
            for name in TRACKS
        }

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare the ellipticity of the PSF and c of all tracks."""
        printed = PublishedFigures.read(self.name)
        quantities = []
        points: list[tuple[complex, tuple[Estimate, Estimate]]] = []
        for name, words in WORDS.items():
            image = point_spread_function(self._pointing(name).unit_visibilities(), self.grid)
            psf = measure_psf(image, self.grid.pixel, WEIGHT_SIGMA).ellipticity
            bias = additive_bias(found, name)
            points.append((psf, bias))
            for part, e in enumerate((psf.real, psf.imag)):
                quantities.append(Quantity(f"e{part + 1} of the PSF, {words}", own=Estimate(e)))
            for part in (0, 1):
                is_printed = name in AS_PAPER
                quantities.append(
                    Quantity(
                        f"c{part + 1}, SNR ≥ 10, {words}",
                        printed.estimate(f"c{part + 1}_snr10") if is_printed else None,
                        None,
                        bias[part],
                    )
                )
        panels = [
            CurvePanel(
                f"$e_{part + 1}$ of the PSF",
                f"additive bias $c_{part + 1}$",
                tuple(
                    Curve(
                        words,
                        [(psf.real, psf.imag)[part]],
                        [bias[part].value],
                        [bias[part].error or 0.0],
                        is_line=False,
                    )
                    for words, (psf, bias) in zip(WORDS.values(), points, strict=True)
                ),
                levels=(0.0,),
            )
            for part in (0, 1)
        ]
        caption = (
            "Additive bias of the mean of isolated galaxies with an SNR of 10 or more against the ellipticity of the"
            " PSF, for tracks that add up to eight hours at declination −30 deg; exact facets."
        )
        leakage = _leakage(points)
        needed = [printed.estimate(f"c{part}_snr10").value / leakage.value for part in (1, 2)]
        remark = (
            f"There are {self.galaxies} galaxies for each track. {_shapes(points)} The text of the paper does not say"
            " whether its track of eight hours is about transit or begins there, so that its c stands beside both. A"
            f" line c = κ e through the origin, with e the ellipticity of the PSF, has κ = {leakage.value:.4f} ±"
            f" {leakage.error or 0.0:.4f} for all tracks and both components together, with χ² ="
            f" {_chi_square(points, leakage.value):.0f} for {2 * len(points) - 1} degrees of freedom. With this κ, the"
            f" paper's c at SNR ≥ 10 would need a PSF of e1 = {signed(needed[0], 2)} and e2 = {signed(needed[1], 2)}."
        )
        return Finding(tuple(quantities), draw_curves(panels), caption, (PAIRED, remark))

    def _pointing(self, name: str) -> PaperPointing:
        return PaperPointing(integration=self.integration, times=TRACKS[name])


def _chi_square(points: Sequence[tuple[complex, tuple[Estimate, Estimate]]], slope: float) -> float:
    """Return the sum of the squares of the distances from a line through the origin, over their errors."""
    return sum(
        ((c.value - slope * e) / (c.error or math.inf)) ** 2
        for psf, both in points
        for c, e in zip(both, (psf.real, psf.imag), strict=True)
    )


def _shapes(points: Sequence[tuple[complex, tuple[Estimate, Estimate]]]) -> str:
    """Compare the PSF of the snapshots with those of the unbroken tracks."""
    modulus = dict(zip(TRACKS, (abs(psf) for psf, _ in points), strict=True))
    additive = [
        abs(complex(*(estimate.value for estimate in c)))
        for name, (_, c) in zip(TRACKS, points, strict=True)
        if name not in AS_PAPER
    ]
    snapshots = [value for name, value in modulus.items() if name not in AS_PAPER]
    return (
        f"The PSF has an ellipticity of modulus {min(snapshots):.2f} to {max(snapshots):.2f} with the snapshots, which"
        f" come closer to the horizon than 8 h about transit ({modulus['8h']:.2f}), and {modulus['later']:.2f} with 8 h"
        " from transit on. Snapshots thus make the PSF rounder only if they replace the latter. With them the modulus"
        f" of c is {min(additive):.4f} to {max(additive):.4f}; the paper requires less than {REQUIRED:g}."
    )


def _leakage(points: Sequence[tuple[complex, tuple[Estimate, Estimate]]]) -> Estimate:
    """Return the slope of c against the ellipticity of the PSF, from both components together."""
    e = np.array([part for psf, _ in points for part in (psf.real, psf.imag)])
    c = np.array([estimate.value for _, both in points for estimate in both])
    error = np.array([estimate.error for _, both in points for estimate in both], float)
    weight = error**-2
    norm = float(np.sum(weight * e**2))
    return Estimate(float(np.sum(weight * e * c)) / norm, norm**-0.5)
