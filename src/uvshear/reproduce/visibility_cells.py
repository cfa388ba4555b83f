"""Cells of the paper's facets, in which simulated visibilities with noise are averaged in different ways."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from uvshear.bias.cell_average import PointingSamples
from uvshear.interferometer.facet import Facet
from uvshear.typing import Array, Complex, Float, Int


@dataclass(frozen=True)
class VisibilityCells:
    """The occupied cells of a facet and the samples in them.

    Parameters
    ----------
    uv
        Baselines of the samples [wavelengths].
    natural
        Natural weights [Jy^-2].
    number
        Number of cells along a side.
    """

    uv: Float[Array, "sample 2"]
    natural: Float[Array, " sample"]
    number: int

    @property
    def half(self) -> int:
        """Number of cells from the origin to the edge."""
        return self.number // 2

    @cached_property
    def side(self) -> float:
        """Side of a cell [wavelengths]."""
        return float(np.hypot(*self.uv.T).max()) * (1 + 1e-9) / self.half

    @cached_property
    def _occupied(self) -> tuple[tuple[Int[Array, " cell"], Int[Array, " cell"]], Array]:
        _, power = self._sums(np.zeros(len(self.uv), np.complex64), self.natural)
        chosen = np.nonzero(power)
        return (chosen[0], chosen[1]), power[chosen]

    @property
    def weight(self) -> Float[Array, " cell"]:
        """Natural weight of each cell."""
        return self._occupied[1]

    @cached_property
    def centres(self) -> Float[Array, "cell 2"]:
        """Centres of the cells [wavelengths]."""
        (i, j), _ = self._occupied
        return np.column_stack([i - self.half + 0.5, j + 0.5]) * self.side

    @cached_property
    def means(self) -> Float[Array, "cell 2"]:
        """Mean baselines of the samples in each cell, with natural weights [wavelengths]."""
        return self.means_with(self.natural)

    def means_with(self, weights: Float[Array, " sample"]) -> Float[Array, "cell 2"]:
        """Return the mean baselines of the samples in each cell with any weights [wavelengths]."""
        # Samples below the axis of u are conjugated, which changes the sign of an imaginary value.
        parts = [self.total(1j * axis, weights).imag for axis in self.uv.T]
        return np.column_stack(parts) / self.power(weights)[:, None]

    def off_centre(self, weights: Float[Array, " sample"]) -> float:
        """Return the rms distance of these means from the centres, over the side of a cell, with natural weights."""
        away = self.means_with(weights) - self.centres
        return (
            math.sqrt(float(np.average(np.sum(away**2, axis=1), weights=self.weight))) / self.side
        )

    def total(
        self, values: Complex[Array, " sample"], weights: Float[Array, " sample"] | None = None
    ) -> Complex[Array, " cell"]:
        """Sum weighted values over each cell; natural weights unless given."""
        sums, _ = self._sums(values, self.natural if weights is None else weights)
        chosen, _ = self._occupied
        return sums[chosen]

    def power(self, weights: Float[Array, " sample"]) -> Float[Array, " cell"]:
        """Sum weights over each cell."""
        _, power = self._sums(np.zeros(len(self.uv), np.complex64), weights)
        chosen, _ = self._occupied
        return power[chosen]

    def _sums(
        self, values: Complex[Array, " sample"], weights: Float[Array, " sample"]
    ) -> tuple[Complex[Array, "u v"], Float[Array, "u v"]]:
        return PointingSamples(self.uv, weights).sums(values, self.side, self.half)

    def natural_facet(self, visibilities: Complex[Array, " sample"]) -> Facet:
        """Return the facet of natural averages."""
        return Facet(self.centres, self.total(visibilities), self.weight)

    def propagated_facet(
        self, visibilities: Complex[Array, " sample"], factors: Float[Array, " sample"]
    ) -> Facet:
        r"""Return the facet of averages with the weights w T, whose errors are those of these averages.

        .. math:: \bar V = \frac{\sum w T V}{\sum w T},\quad \sigma^{-2} = \frac{(\sum w T)^2}{\sum w T^2}
        """
        once = self.power(self.natural * factors)
        power = once**2 / self.power(self.natural * factors**2)
        mean = self.total(visibilities, self.natural * factors) / once
        return Facet(self.centres, mean * power, power)

    def weighted_facet(
        self,
        visibilities: Complex[Array, " sample"],
        factors: Float[Array, " sample"],
        scale: float,
    ) -> Facet:
        """Return the facet whose likelihood has the weights w T scale in place of the inverse variances."""
        weights = self.natural * factors * scale
        return Facet(self.centres, self.total(visibilities, weights), self.power(weights))
