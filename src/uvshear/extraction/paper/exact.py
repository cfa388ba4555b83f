r"""Exact facets: dirty cutout and dirty beam, the sufficient statistics of a source.

For any model of brightness I around the direction s,

.. math:: \langle d, m\rangle = \sum_x I(x)\, b(x), \qquad \langle m, m\rangle = \sum_{x,y} I(x) P(x-y) I(y),

b the natural-weight dirty image of the data and P the dirty beam at s. Both sums run here in Fourier space
over the cutout's own grid, where I is analytic. The cutout truncates the dirty image. In the residual form,

    D = F[crop(dirty(data - all models))] + S FP M,

the source's own model M is added back with the same discrete operator FP that gives <m, m>. Truncation then affects the
residual only, and the true model is a fixed point whatever the size of the facet.
"""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy import fft

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.extraction.paper.facets import FacetBuilder, FacetMethod, Target, spectral_gain
from uvshear.galaxy import Galaxies, Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.imaging import ImageGrid, dirty_image
from uvshear.imaging.phase import baselines_seen_from, shift_phase_centre
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Visibilities
from uvshear.numerics.fft_sizes import fast_size
from uvshear.numerics.half_plane import half_plane
from uvshear.typing import Array, Bool, Float

OVERSAMPLING = 1.2
"""Nyquist frequency of the facet's pixels over the longest baseline in it."""

WIDEST = 3.8
"""Largest width of a facet over its first width, 1.25^6."""

LARGEST_PHASE = 0.5
"""Phase pi w x^2 at the facet's edge above which the gridder's w-planes are used, at four times the cost [rad]. The
phase centre and the slope of w (n - 1) there are exact; this second order affects the residual only."""


@dataclass(frozen=True)
class ExactFacets(FacetMethod):
    """Method with facets of ``scale_lengths`` median scale lengths, wider for galaxies that turn out to be larger."""

    scale_lengths: float = 45.0
    epsilon: float = 1e-5

    def open(
        self,
        target: Target,
        profile: Profile,
        power: Float[Array, " cell"] | None = None,
    ) -> FacetBuilder:
        """Begin the facet of one source."""
        uv_max = target.informative_uv_max
        pixel = 1 / (2 * OVERSAMPLING * uv_max)
        # Sizes with factors up to 11 lie closer to one another than those with factors up to 5.
        size = fast_size(max(self._width(target) / pixel, 32), real=False)
        grid = ImageGrid(size, pixel)
        band = UvRange(target.uv_range.minimum, uv_max)
        return _ExactBuilder(target, profile, grid, band, self.epsilon, power)

    def _width(self, target: Target) -> float:
        """Width of a facet, wider by a power of 1.25 where the galaxy requires it, so that beams can be reused."""
        least = self.scale_lengths * target.scale_length
        wanted = min(2 * target.half_width, WIDEST * least)
        steps = math.ceil(math.log(max(wanted / least, 1.0)) / math.log(1.25) - 1e-9)
        return least * 1.25**steps


class _ExactBuilder(FacetBuilder):
    def __init__(
        self,
        target: Target,
        profile: Profile,
        grid: ImageGrid,
        band: UvRange,
        epsilon: float,
        power: Float[Array, " cell"] | None,
    ) -> None:
        self._galaxy, self._profile = target.galaxy, profile
        self._l, self._m = float(target.galaxy.l[0]), float(target.galaxy.m[0])
        self._band, self._grid, self._epsilon = band, grid, epsilon
        self._cutout = np.zeros((grid.size, grid.size))
        # Outside the range there is nothing but what truncation spills: power of either sign.
        cells = half_plane(grid.size, grid.pixel, band.minimum, band.maximum)
        self._uv, self._multiplicity, self._kept = cells.uv, cells.multiplicity, cells.index
        # The beam does not depend on any model: one pass is enough, unless the facet has grown since.
        is_known = power is not None and len(power) == len(self._uv)
        self._power = np.asarray(power, float) if is_known else None
        self._beam = np.zeros((grid.size, grid.size))

    def add(self, residual: Visibilities, model: Galaxies) -> None:
        uvw = baselines_seen_from(residual.uvw, self._l, self._m)
        seen = Visibilities(uvw, residual.frequency, residual.stokes_i, residual.weights)
        distance = seen.uv_distance
        mask = (distance >= self._band.minimum) & (distance <= self._band.maximum)
        mask &= residual.weights > 0
        rows = np.flatnonzero(mask.any(axis=1))
        if len(rows) == 0:
            return
        if len(rows) < len(mask):
            uvw, mask = uvw[rows], mask[rows]
        vis = residual.stokes_i[rows].astype(np.complex64)
        shifted = shift_phase_centre(residual.uvw[rows], residual.frequency, vis, self._l, self._m)
        gain = spectral_gain(self._galaxy, residual.frequency)
        weights = residual.weights[rows]
        self._cutout += self._image(uvw, residual.frequency, shifted, weights * gain, mask)
        if self._power is None:
            ones = np.ones_like(vis)
            self._beam += self._image(uvw, residual.frequency, ones, weights * gain**2, mask)

    def _image(
        self,
        uvw: Float[Array, "row 3"],
        frequency: Float[Array, " chan"],
        vis: Array,
        weights: Float[Array, "row chan"],
        mask: Bool[Array, "row chan"],
    ) -> Float[Array, "l m"]:
        return dirty_image(
            uvw,
            frequency,
            vis,
            weights,
            self._grid,
            with_w=self._needs_w(uvw, frequency),
            mask=mask,
            epsilon=self._epsilon,
        )

    def _needs_w(self, uvw: Float[Array, "row 3"], frequency: Float[Array, " chan"]) -> bool:
        half_width = self._grid.size * self._grid.pixel / 2
        w_max = float(np.abs(uvw[:, 2]).max() * frequency.max()) / SPEED_OF_LIGHT
        return math.pi * w_max * half_width**2 > LARGEST_PHASE

    def merge(self, later: Self) -> None:
        self._cutout += later._cutout
        self._beam += later._beam

    def facet(self, model: Galaxies) -> Facet:
        uv, kept = self._uv, self._kept
        scale = self._multiplicity / self._grid.size**2
        power = self._power
        if power is None:
            power = _transform(self._beam)[kept].real * scale
        correlation = _transform(self._cutout)[kept].conj() * scale
        size = quadratic_form(model.ellipticity, model.scale_length)
        a, b, c = (4 * math.pi**2 * float(x[0]) for x in size)
        u, v = uv.T
        envelope = self._profile.envelope(a * u**2 + b * u * v + c * v**2)
        offset = float(model.l[0]) - self._l, float(model.m[0]) - self._m
        phase = np.exp(2j * math.pi * (u * offset[0] + v * offset[1]))
        correlation += float(model.flux[0]) * power * envelope * phase
        return Facet(uv, correlation, power)


def _transform(image: Float[Array, "l m"]) -> Array:
    """Fourier transform about the image's centre; its unpaired first row and column are left out."""
    paired = image.copy()
    paired[0, :] = paired[:, 0] = 0
    return fft.rfft2(fft.ifftshift(paired))
