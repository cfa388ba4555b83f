"""Metacalibration of anything that is measured on a facet, and of the ellipticity in particular."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.extraction.cutout import Cutout, cutout
from uvshear.fit.measurement import FitFlag
from uvshear.fit.metacal import REACH, STEP, WIDEST, Metacalibration, scale_of
from uvshear.fit.prior import ShapePrior
from uvshear.fit.shape import measure_shape
from uvshear.galaxy import DiscEllipticityPrior, EllipticityPrior, Exponential, Profile
from uvshear.interferometer.facet import Facet
from uvshear.measurement.keep import Kept, SourceName, Statistic
from uvshear.shear.weight import lensfit_weight
from uvshear.typing import Array, Complex, Float

Measure = Callable[[Facet, Cutout], Float[Array, " 2"] | None]
"""From a facet and its cells to two numbers; None where that fails, which counts as zeros: shear may make it fail."""

_Key = tuple[int, float, tuple[float, ...]]

_LONGEST = REACH * WIDEST * (1 + STEP)
"""Baselines that a round beam may take [wavelengths]."""

Term = tuple[Float[Array, " 2"], Float[Array, "2 2"]]
"""Two numbers of a galaxy, and their derivatives by g1, g2 (the second index)."""


class Metacal:
    """Measures galaxies behind a round beam, and how what is measured responds to a shear of the data."""

    def __init__(self) -> None:
        """Weights are kept for facets of the same cells."""
        self._known: dict[_Key, _Known] = {}

    def term(
        self, facet: Facet, cells: Cutout, noise: Complex[Array, " cell"], measure: Measure
    ) -> Term | None:
        """Numbers and responses of a galaxy, with ``noise`` in standard deviations of each cell's added.

        None where it was never measured.
        """
        longest = min(cells.longest, _LONGEST)
        is_near = np.hypot(*facet.uv.T) <= longest
        facet, noise = facet.within(longest), noise[is_near]
        total, shape = facet.beam_shape()
        key = cells.size, longest, shape
        if key not in self._known:
            self._known[key] = _Known.of(facet, cells, total)
        known = self._known[key]
        # Weights are those of a facet whose unit of flux may be another.
        unit = math.sqrt(total / known.total)
        seen = known.metacalibration.of(facet.correlation / unit, noise)
        facets = [seen.still, *seen.moved[0], *seen.moved[1]]
        found = [measure(one.in_other_unit(unit), known.round_cells) for one in facets]
        if all(one is None for one in found):
            return None
        value, *moved = (np.zeros(2) if one is None else one for one in found)
        slopes = [(up - down) / (2 * STEP) for up, down in (moved[:2], moved[2:])]
        return value, np.stack(slopes, axis=-1)


@dataclass(frozen=True)
class _Known:
    """Weights for facets of one size and beam, the sum of whose power was ``total``."""

    total: float
    metacalibration: Metacalibration
    round_cells: Cutout

    @classmethod
    def of(cls, facet: Facet, cells: Cutout, total: float) -> Self:
        power = np.asarray(facet.power, float)
        scale = scale_of(facet.uv, power)
        round_cells = cutout(cells.size, cells.pixel, 0.0, REACH * scale)
        metacalibration = Metacalibration(
            facet.uv,
            power,
            cells.size * cells.pixel,
            scale,
            round_cells.uv,
            round_cells.multiplicity,
        )
        return cls(total, metacalibration, round_cells)


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

    def of(self, facet: Facet, cutout: Cutout, prior: ShapePrior, name: SourceName) -> Kept:
        """Measure it, and four times more for the response."""

        def measure(one: Facet, _: Cutout) -> Float[Array, " 2"] | None:
            shape = measure_shape(one, prior, self._profile)
            if shape.flag is not FitFlag.OK:
                return None
            weight = lensfit_weight(np.array([shape.e_sigma]), self._population)
            return weight * shape.ellipticity

        rng = np.random.default_rng([self._seed, *name])
        first, second = rng.standard_normal((2, len(facet.power)))
        term = self._metacal.term(facet, cutout, first + 1j * second, measure)
        if term is None:
            return {}
        value, response = term
        numbers = [*value.tolist(), *response.ravel().tolist()]
        return dict(zip(self.columns, numbers, strict=True))
