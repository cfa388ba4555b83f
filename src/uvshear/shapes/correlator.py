"""Correlation of a facet with templates: the sums over cells of which every likelihood consists.

Positions are in units of the correlator's ``length``, fluxes in units of its ``flux_unit``.
"""

import math

import numpy as np

from uvshear.galaxy import Profile
from uvshear.geometry.ellipticity import (
    quadratic_form,
    quadratic_form_derivatives,
    quadratic_form_of,
)
from uvshear.interferometer.facet import Facet
from uvshear.shapes import kernels
from uvshear.shapes.normal_sums import COUNT, NormalSums
from uvshear.typing import Array, Complex, Float

BLOCK = kernels.BLOCK
"""Number of cells in a block of the matrix product."""

CHUNK = 8 * BLOCK
"""Number of cells on which the templates of a batch are computed at a time; this many fit into the level-2 cache."""

TEMPLATES = 48
"""Number of templates in a batch."""


class Correlator:
    """One facet in the units of its fit, with its own work space, so that two threads must not share a correlator.

    uv is divided by its largest value, and the weighted data by the square root of the total power. The numbers are
    then of order one and suit float32, the default ``dtype``, which is twice as fast as float64.
    """

    def __init__(
        self, facet: Facet, profile: Profile, dtype: type[np.floating] = np.float32
    ) -> None:
        uv_max = float(np.max(np.abs(facet.uv)))
        total = float(np.sum(facet.power))
        self.length = 1 / (2 * math.pi * uv_max)
        self.flux_unit = 1 / math.sqrt(total)
        self.profile = profile
        self.xy = np.ascontiguousarray((facet.uv / uv_max).T, dtype)
        self.power = (facet.power / total).astype(dtype)
        self._x, self._y = self.xy
        self._displace = kernels.displace_single if dtype is np.float32 else kernels.displace
        correlation = facet.correlation / math.sqrt(total)
        self._origin = (
            np.ascontiguousarray(correlation.real, dtype),
            np.ascontiguousarray(correlation.imag, dtype),
        )
        self._centred = self._origin
        self._q = np.empty(self._x.size, dtype)
        self.centre = np.zeros(2)
        self._widths: dict[float, float] = {}

    def move_to(self, centre: Float[Array, " 2"]) -> None:
        """Put the origin of positions at ``centre``, relative to the centre of the facet in units of ``length``."""
        real, imaginary = np.empty_like(self._q), np.empty_like(self._q)
        self._displace(self._x, self._y, centre[0], centre[1], *self._origin, real, imaginary)
        self._centred = (real, imaginary)
        self.centre = np.array(centre, float)

    def peak_width(self, log_scale_length: float) -> float:
        """Gaussian sigma of the autocorrelation of a round galaxy of this size, which no data enter."""
        if log_scale_length not in self._widths:
            form = self.form(0j, log_scale_length)
            sums = self.normal_sums(form, np.zeros((3, 3)))
            norm, curvature = sums.norm, float(np.trace(sums.position_curvature))
            is_known = norm > 0 and curvature > 0
            width = math.sqrt(2 * norm / curvature) if is_known else 1.0
            self._widths[log_scale_length] = width
        return self._widths[log_scale_length]

    def point_at(self, position: Float[Array, " 2"]) -> tuple[float, Float[Array, " 2"]]:
        """<d, m> of a point of unit flux, and its gradient.

        Parameters
        ----------
        position
            Position of the point, relative to the centre of the facet in units of ``length``.
        """
        product, *gradient = kernels.displaced_sums(
            self._x, self._y, float(position[0]), float(position[1]), *self._origin
        )
        return product, np.array(gradient)

    def form(self, ellipticity: complex, log_scale_length: float) -> Float[Array, " 3"]:
        """Coefficients of q = 4 pi^2 alpha^2 |A^-T k|^2 as a quadratic form of the scaled uv."""
        return quadratic_form_of(ellipticity, math.exp(log_scale_length) / self.length)

    def form_derivatives(
        self, ellipticity: complex, log_scale_length: float
    ) -> Float[Array, "3 3"]:
        """Differentiate :meth:`form` with respect to e1, e2 and ln alpha, one row each."""
        return quadratic_form_derivatives(ellipticity, math.exp(log_scale_length) / self.length)

    def envelope(self, form: Float[Array, " 3"]) -> Float[Array, " cell"]:
        """Fourier transform of a template of unit flux on the cells."""
        kernels.quadratic(self._x, self._y, form, self._q)
        return self.profile.envelope(self._q)

    def displaced_to(self, nodes: Float[Array, "node 2"]) -> Float[Array, "node cell"]:
        """Real part of the data with each node, given relative to the present centre, moved to the origin."""
        real = np.empty((len(nodes), self._q.size), self._q.dtype)
        imaginary = np.empty_like(self._q)
        for node, row in zip(nodes, real, strict=True):
            self._displace(self._x, self._y, node[0], node[1], *self._centred, row, imaginary)
        return real

    def correlate(
        self,
        ellipticity: Complex[Array, " sample"],
        log_scale_length: Float[Array, " sample"],
        displaced: Float[Array, "node cell"],
    ) -> tuple[Float[Array, "sample node"], Float[Array, " sample"]]:
        """Cross-correlation <d, m> of each template at each node, and <m, m> of each template.

        This is a matrix product of templates and displaced data over blocks of cells: it runs in the precision of the
        correlator within a block, and in float64 over the blocks. Callers limit BLAS to one thread
        (``execution.single_threaded_libraries``): with two, these small products take three times the processor time.

        Parameters
        ----------
        ellipticity, log_scale_length
            Shapes of the templates; the size is ln(scale length / rad).
        displaced
            Data at the nodes, from :meth:`displaced_to`.
        """
        size = np.exp(log_scale_length) / self.length
        forms = np.stack(quadratic_form(ellipticity, size), axis=-1)
        heights, norm = np.zeros((len(forms), len(displaced))), np.zeros(len(forms))
        for first in range(0, len(forms), TEMPLATES):
            batch = slice(first, first + TEMPLATES)
            for start in range(0, self._q.size, CHUNK):
                cells = slice(start, start + CHUNK)
                envelopes = self._envelopes(forms[batch], cells)
                kernels.add_norms(envelopes, self.power[cells], norm[batch])
                heights[batch] += _blocked_product(envelopes, displaced[:, cells])
        return heights, norm

    def _envelopes(
        self, forms: Float[Array, "sample 3"], cells: slice
    ) -> Float[Array, "sample cell"]:
        x, y = self._x[cells], self._y[cells]
        q = np.empty((len(forms), x.size), x.dtype)
        kernels.quadratics(x, y, forms, q)
        return self.profile.envelope(q)

    def normal_sums(self, form: Float[Array, " 3"], derivatives: Float[Array, "3 3"]) -> NormalSums:
        """Gauss-Newton sums at the present centre, of a template with the given :meth:`form` and its derivatives."""
        envelope = self.envelope(form)
        slope = self.profile.envelope_slope(self._q)
        sums = np.empty(COUNT)
        kernels.normal_sums(
            envelope, slope, self._x, self._y, derivatives, *self._centred, self.power, sums
        )
        return NormalSums(sums)


def _blocked_product(
    templates: Float[Array, "sample cell"], data: Float[Array, "node cell"]
) -> Float[Array, "sample node"]:
    """Sum templates x data over the cells: in their precision within a block, in float64 over the blocks."""
    whole = templates.shape[1] // BLOCK * BLOCK
    blocks = [
        part[:, :whole].reshape(len(part), -1, BLOCK).swapaxes(0, 1) for part in (templates, data)
    ]
    product = np.matmul(blocks[0], blocks[1].swapaxes(1, 2)).sum(axis=0, dtype=float)
    return product + templates[:, whole:] @ data[:, whole:].T
