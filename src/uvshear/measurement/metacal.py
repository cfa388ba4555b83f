"""Metacalibration of anything that is measured on a facet, and of the ellipticity in particular."""

from collections.abc import Callable

import numpy as np

from uvshear.extraction.cutout import Cutout, cutout
from uvshear.fit.measurement import FitFlag
from uvshear.fit.metacal import REACH, SCALE, STEP, Metacalibration
from uvshear.fit.prior import ShapePrior
from uvshear.fit.shape import measure_shape
from uvshear.galaxy import DiscEllipticityPrior, EllipticityPrior, Exponential, Profile
from uvshear.interferometer.facet import Facet
from uvshear.measurement.keep import Kept, Statistic
from uvshear.shear.weight import lensfit_weight
from uvshear.typing import Array, Complex, Float

Measure = Callable[[Facet, Cutout], Float[Array, " 2"] | None]
"""From a facet and its cells to two numbers; None where that fails, which counts as zeros: shear may make it fail."""

Term = tuple[Float[Array, " 2"], Float[Array, "2 2"]]
"""Two numbers of a galaxy, and their derivatives by g1, g2 (the second index)."""


class Metacal:
    """Measures galaxies behind a round beam, and how what is measured responds to a shear of the data."""

    def __init__(self) -> None:
        """Weights are kept for facets of the same cells."""
        self._known: dict[tuple[Cutout, float], Metacalibration] = {}

    def term(
        self, facet: Facet, cells: Cutout, noise: Complex[Array, " cell"], measure: Measure
    ) -> Term | None:
        """Numbers and responses of a galaxy, with ``noise`` in standard deviations of each cell's added.

        None where it was never measured.
        """
        round_cells = cutout(cells.size, cells.pixel, 0.0, REACH * SCALE)
        key = cells, float(facet.power[0])
        if key not in self._known:
            width = cells.size * cells.pixel
            self._known[key] = Metacalibration(
                facet.uv,
                np.asarray(facet.power, float),
                width,
                round_cells.uv,
                round_cells.multiplicity,
            )
        seen = self._known[key].of(facet.correlation, noise)
        facets = [seen.still, *seen.moved[0], *seen.moved[1]]
        found = [measure(one, round_cells) for one in facets]
        if all(one is None for one in found):
            return None
        value, *moved = (np.zeros(2) if one is None else one for one in found)
        slopes = [(up - down) / (2 * STEP) for up, down in (moved[:2], moved[2:])]
        return value, np.stack(slopes, axis=-1)


class MetacalStatistic(Statistic):
    """Weighted ellipticity behind a round beam, and its response."""

    columns = ("mc1", "mc2", "mc_r11", "mc_r12", "mc_r21", "mc_r22")

    def __init__(
        self,
        profile: Profile | None = None,
        population: EllipticityPrior | None = None,
        seed: int = 1,
    ) -> None:
        """``profile`` is what galaxies are fitted with, the ``population`` makes the weights."""
        self._profile = profile or Exponential()
        self._population = population or DiscEllipticityPrior()
        self._metacal, self._seed = Metacal(), seed

    def of(self, facet: Facet, cutout: Cutout, prior: ShapePrior, source: int) -> Kept:
        """Measure it, and four times more for the response."""

        def measure(one: Facet, _: Cutout) -> Float[Array, " 2"] | None:
            shape = measure_shape(one, prior, self._profile)
            if shape.flag is not FitFlag.OK:
                return None
            weight = lensfit_weight(np.array([shape.e_sigma]), self._population)
            return weight * shape.ellipticity

        rng = np.random.default_rng([self._seed, source])
        first, second = rng.standard_normal((2, len(facet.power)))
        term = self._metacal.term(facet, cutout, first + 1j * second, measure)
        if term is None:
            return {}
        value, response = term
        numbers = [*value.tolist(), *response.ravel().tolist()]
        return dict(zip(self.columns, numbers, strict=True))
