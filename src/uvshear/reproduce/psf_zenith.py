"""Target ``psf-zenith``: ellipticity and size of the PSF against the distance from the zenith (section 6)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.diagnostics.psf import point_spread_function
from uvshear.imaging import ImageGrid
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.paper_pointing import (
    ABOUT_TRANSIT,
    FROM_TRANSIT,
    PaperPointing,
)
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.psf_moments import APERTURES, SizesInApertures
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.typing import Array, Float

TRACKS = {"about transit": ABOUT_TRANSIT, "from transit on": FROM_TRANSIT}
"""Tracks of eight hours: centred on transit as elsewhere, and with transit at its beginning, as the caption of the
figure in the paper may be read."""

COARSE_GRID = ImageGrid(256, 0.2 * ARCSEC)
"""Pixels that are small enough for moments within some arcseconds."""

WEIGHT_SIGMA = 3 * ARCSEC
"""Standard deviation of the Gaussian with which the ellipticities are measured [rad]."""


@dataclass(frozen=True)
class PsfZenith(PaperTarget):
    """Moments of the natural PSF at several distances from the zenith.

    Parameters
    ----------
    distances
        Distances of the transit from the zenith [rad].
    integration
        Length of a sample [s].
    grid
        Pixels of the image of the PSF.
    """

    name = "psf-zenith"
    title = "Ellipticity and size of the PSF against zenith distance"

    distances: tuple[float, ...] = tuple(math.radians(10.0 * k) for k in range(7))
    integration: float = 60.0
    grid: ImageGrid = COARSE_GRID

    def tasks(self) -> Mapping[str, PaperPointing]:
        """Return the observations."""
        return {
            _part(track, distance): PaperPointing.from_zenith(distance, self.integration, times)
            for track, times in TRACKS.items()
            for distance in self.distances
        }

    def measure(self, task: PaperPointing) -> Mapping[str, Array]:
        """Measure the moments of a PSF in all apertures: e1, e2 and R [rad^2]."""
        image = point_spread_function(task.unit_visibilities(), self.grid)
        found = {}
        for k, aperture in enumerate(APERTURES):
            values = [
                aperture.moments(image, self.grid.pixel, width)
                for width in (*aperture.widths, WEIGHT_SIGMA)
            ]
            found[f"aperture_{k}"] = np.array([[e.real, e.imag, size] for e, size in values])
        return found

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Find the aperture that gives the paper's size at the zenith, and compare the sizes far from it."""
        printed = PublishedFigures.read(self.name)
        small, large = (
            printed.estimate(name) for name in ("smallest_size_arcsec2", "largest_size_arcsec2")
        )
        quantities, remarks, curves = [], [], {}
        panels: list[tuple[Curve, ...]] = [(), (), ()]
        degrees = [math.degrees(distance) for distance in self.distances]
        for track in TRACKS:
            gaussian = self._values(found, track, 0)[:, -1]
            _, sizes = self._sizes_as_in_print(found, track, 0, small.value)
            for k, values in enumerate((gaussian[:, 0], gaussian[:, 1], sizes)):
                curve = Curve(track, degrees, values.tolist())
                panels[k] = (*panels[k], curve)
                curves[f"{track}, {('e1', 'e2', 'R [arcsec2]')[k]}"] = curve.y
            for name, place in (("the zenith", 0), (f"{degrees[-1]:.0f} deg", -1)):
                for k, part in enumerate(("e1", "e2")):
                    quantities.append(
                        Quantity(
                            f"{part} of the PSF at {name}, track {track}",
                            own=Estimate(float(gaussian[place, k])),
                        )
                    )
            rows, sentences = self._sizes(found, track, small, large)
            quantities += rows
            remarks += sentences
        published = Curve(
            "Rivi & Miller 2018",
            [degrees[0], degrees[-1]],
            [small.value, large.value],
            is_published=True,
            is_line=False,
        )
        names = ("$e_1$ of the PSF", "$e_2$ of the PSF", r"$R$ [arcsec$^2$]")
        picture = draw_curves(
            [
                CurvePanel(
                    "zenith distance of the transit [deg]",
                    name,
                    (*panel, *((published,) * (k == 2))),
                )
                for k, (name, panel) in enumerate(zip(names, panels, strict=True))
            ]
        )
        caption = (
            "Ellipticity and size of the PSF with natural weighting against the distance of the transit from the"
            f" zenith, for tracks of eight hours. The moments have a Gaussian weight with the ellipticity of the PSF;"
            f" its standard deviation is {WEIGHT_SIGMA / ARCSEC:g} arcsec for the ellipticity, and for R that with"
            " which R at the zenith is the paper's. Crosses: the range of R that the paper states, drawn at the ends of"
            " our range of distances."
        )
        first = (
            "Far from the zenith the uv coverage is compressed along v, so that the PSF is stretched along m and its e1"
            " decreases. The paper calls the PSF compressed along y, which is true of the uv coverage. Without an"
            " aperture the moments are not defined, because the integral of a PSF without zero baselines is zero. The"
            " paper does not state its aperture, nor the distance at which R is"
            f" {large.value:g} arcsec². For each kind of aperture we choose the width that gives the paper's R at the"
            f" zenith, and predict R at {degrees[-1]:.0f} deg with the same width."
        )
        return Finding(tuple(quantities), picture, caption, (first, *remarks), curves)

    def _sizes(
        self,
        found: Mapping[str, Mapping[str, Array]],
        track: str,
        small: Estimate,
        large: Estimate,
    ) -> tuple[list[Quantity], list[str]]:
        """Compare R far from the zenith, in the apertures that reproduce R at the zenith."""
        quantities, sentences = [], []
        degrees = np.degrees(self.distances)
        for k, aperture in enumerate(APERTURES):
            chosen, sizes_at_width = self._sizes_as_in_print(found, track, k, small.value)
            if not math.isfinite(chosen):
                sentences.append(
                    f"No {aperture.name} up to {aperture.widths[-1] / ARCSEC:g} arcsec gives R = {small.value:g}"
                    f" arcsec² at the zenith (track {track})."
                )
                continue
            quantities.append(
                Quantity(
                    f"R at {degrees[-1]:.0f} deg [arcsec²], {aperture.words(chosen)}, track {track}",
                    large,
                    Estimate(float(sizes_at_width[-1])),
                )
            )
            reached = SizesInApertures(degrees, sizes_at_width).width_of(large.value)
            if math.isfinite(reached):
                sentences.append(
                    f"With the {aperture.words(chosen)} (track {track}), R is"
                    f" {large.value:g} arcsec² at {reached:.0f} deg."
                )
        return quantities, sentences

    def _sizes_as_in_print(
        self, found: Mapping[str, Mapping[str, Array]], track: str, aperture: int, at_zenith: float
    ) -> tuple[float, Float[Array, " distance"]]:
        """Return the width with which an aperture gives the paper's R at the zenith [rad], and R with it [arcsec^2].

        The width is not finite if there is none.
        """
        width = np.array(APERTURES[aperture].widths)
        sizes = self._values(found, track, aperture)[:, :-1, 2] / ARCSEC**2
        chosen = SizesInApertures(width, sizes[0]).width_of(at_zenith)
        return chosen, np.array([np.interp(chosen, width, size) for size in sizes])

    def _values(
        self, found: Mapping[str, Mapping[str, Array]], track: str, aperture: int
    ) -> Float[Array, "distance width 3"]:
        parts = [found[_part(track, distance)] for distance in self.distances]
        return np.array([part[f"aperture_{aperture}"] for part in parts])


def _part(track: str, distance: float) -> str:
    return f"{track.replace(' ', '-')}-{math.degrees(distance):.0f}"
