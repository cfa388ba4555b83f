"""Target ``psf-images``: the PSF with natural and with uniform weighting (section 4.1)."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from uvshear.constants import ARCMIN, ARCSEC
from uvshear.diagnostics.psf import point_spread_function
from uvshear.imaging import ImageGrid
from uvshear.imaging.ring_means import ring_means
from uvshear.interferometer.weighting import Uniform, Weighting, weighted
from uvshear.plot.psf_pair import draw_psf_pair
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.paper_pointing import BASELINE, PSF_GRID, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.typing import Array, Float

NATURAL, UNIFORM = "natural", "uniform"


@dataclass(frozen=True)
class PsfImages(PaperTarget):
    """Images of the PSF of the observation at declination -30 deg.

    Parameters
    ----------
    pointing
        The observation.
    grid
        Pixels of the images.
    field
        Width of the field of view whose inverse is the side of a cell of the uniform weighting [rad].
    plateau
        Range of distances from the centre in which the level of the plateau is measured [rad].
    """

    name = "psf-images"
    title = "PSF with natural and with uniform weighting"

    pointing: PaperPointing = BASELINE
    grid: ImageGrid = PSF_GRID
    field: float = 2 * ARCMIN
    plateau: tuple[float, float] = (10 * ARCSEC, 20 * ARCSEC)

    def tasks(self) -> Mapping[str, tuple[Weighting, ...]]:
        """Return the weightings."""
        return {NATURAL: (), UNIFORM: (Uniform(self.field),)}

    def measure(self, task: tuple[Weighting, ...]) -> Mapping[str, Array]:
        """Image the PSF."""
        seen = weighted(self.pointing.unit_visibilities(), task)
        return {"image": point_spread_function(seen, self.grid).astype(np.float32)}

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Measure both images and draw them."""
        images = {name: np.asarray(part["image"], float) for name, part in found.items()}
        inner, outer = (edge / ARCSEC for edge in self.plateau)
        quantities = []
        for name, image in images.items():
            quantities += [
                Quantity(
                    f"full width at half maximum, {name} weighting [arcsec]",
                    own=Estimate(self._full_width(image) / ARCSEC),
                ),
                Quantity(
                    f"mean level at {inner:g} to {outer:g} arcsec, divided by the peak, {name} weighting",
                    own=Estimate(float(image[self._ring].mean())),
                ),
            ]
        caption = (
            f"PSF of SKA-Mid AA4 in eight hours about transit at a declination of"
            f" {np.degrees(self.pointing.declination):.1f} deg, with natural (left) and uniform (right) weighting."
            " East is to the left. The scale is the inverse hyperbolic sine, which shows the plateau and the peak."
            " The lower panels have the means over rings, against the logarithm of the distance."
        )
        remarks = (
            f"The uniform weighting has cells of the uv plane that are the inverse of {self.field / ARCMIN:g} arcmin"
            " wide, as the cells of the largest facets of Table 1; the paper does not state its cells. The full width"
            " is that of the means over rings.",
        )
        picture = draw_psf_pair(images, self.grid.pixel)
        return Finding(tuple(quantities), picture, caption, remarks)

    def _full_width(self, image: Float[Array, "l m"]) -> float:
        """Return twice the distance at which the mean over rings falls to half of the peak [rad]."""
        distance, mean = ring_means(image, self.grid.pixel)
        beyond = int(np.argmax(mean < mean[0] / 2))
        return 2 * float(
            np.interp(
                -mean[0] / 2, -mean[beyond - 1 : beyond + 1], distance[beyond - 1 : beyond + 1]
            )
        )

    @cached_property
    def _ring(self) -> Array:
        offset = (np.arange(self.grid.size) - self.grid.size // 2) * self.grid.pixel
        distance: Float[Array, "l m"] = np.hypot(offset[:, None], offset[None, :])
        return (distance >= self.plateau[0]) & (distance <= self.plateau[1])
