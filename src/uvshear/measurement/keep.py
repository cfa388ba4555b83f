"""What is kept of every source beside its shape, for estimators of the shear that need more."""

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from uvshear.extraction.cutout import Cutout
from uvshear.fit.condensed import Condenser
from uvshear.fit.likelihood import sample_likelihood
from uvshear.fit.moments import REACH, SCALE, MomentFunctional
from uvshear.fit.prior import ShapePrior
from uvshear.galaxy import DiscEllipticityPrior, EllipticityPrior, Exponential, Profile
from uvshear.interferometer.facet import Facet
from uvshear.shear.bayesian import ShapeLikelihood
from uvshear.shear.packing import PACKED, pack
from uvshear.typing import Array

_Key = tuple[int, float, float]

Kept = Mapping[str, float | Array]
"""Of a source: a number or a one-dimensional array a column."""


class Statistic(ABC):
    """Numbers of a source, from the facet that its shape is measured on."""

    columns: tuple[str, ...]

    @abstractmethod
    def of(self, facet: Facet, cutout: Cutout, prior: ShapePrior, source: int) -> Kept:
        """Work out the value of each column, for a source of this prior and number; nothing where there is none."""


class MomentStatistic(Statistic):
    """Moments of the visibility function about the catalogue's position, with their responses and noise [Jy]."""

    columns = ("m1", "m2", "m_size", "r11", "r12", "r22", "r_third", "m1_var", "m2_var", "m12_cov")

    def __init__(self, position_sigma: float = 0.0) -> None:
        """``position_sigma`` is the error of the catalogue's position in l and in m [rad]."""
        self._position_sigma = position_sigma
        self._functionals: dict[_Key, MomentFunctional] = {}
        self._on_cells: dict[tuple[_Key, Cutout], MomentFunctional] = {}

    def of(
        self, facet: Facet, cutout: Cutout, prior: ShapePrior, source: int
    ) -> Mapping[str, float]:
        """Measure them; no prior has a part in it."""
        moments = self._functional(facet, cutout).measure(facet.correlation)
        return {
            "m1": float(moments.shape[0]),
            "m2": float(moments.shape[1]),
            "m_size": moments.size,
            "r11": float(moments.response[0, 0]),
            "r12": float(moments.response[0, 1]),
            "r22": float(moments.response[1, 1]),
            "r_third": moments.third,
            "m1_var": float(moments.covariance[0, 0]),
            "m2_var": float(moments.covariance[1, 1]),
            "m12_cov": float(moments.covariance[0, 1]),
        }

    def _functional(self, facet: Facet, cutout: Cutout) -> MomentFunctional:
        # Sources of one size and one beam share its power, all but for long baselines that moments do not take.
        longest = min(cutout.longest, 1.5 * REACH * SCALE)
        key = cutout.size, longest, float(facet.power[0])
        if key not in self._functionals:
            width = cutout.size * cutout.pixel
            self._functionals[key] = MomentFunctional(
                facet.uv, np.asarray(facet.power, float), width, self._position_sigma
            )
        if (key, cutout) not in self._on_cells:
            self._on_cells[key, cutout] = self._functionals[key].on(facet.uv)
        return self._on_cells[key, cutout]


class LikelihoodStatistic(Statistic):
    """Likelihood over ellipticity and size, wherever a population of galaxies reaches."""

    columns = PACKED

    def __init__(
        self, profile: Profile | None = None, population: EllipticityPrior | None = None
    ) -> None:
        """``profile`` is what galaxies are fitted with."""
        self._profile = profile or Exponential()
        self._population = population or DiscEllipticityPrior()
        self._condenser = Condenser(self._profile)

    def of(self, facet: Facet, cutout: Cutout, prior: ShapePrior, source: int) -> Kept:
        """Sample it, and pack it into a few kilobytes."""
        likelihood = self.likelihood(facet, cutout, prior)
        return {} if likelihood is None else pack(likelihood)

    def likelihood(self, facet: Facet, cutout: Cutout, prior: ShapePrior) -> ShapeLikelihood | None:
        """Sample it; None where there is no galaxy."""
        found = sample_likelihood(
            facet,
            prior,
            self._profile,
            self._population,
            lambda: self._condenser.of(facet, cutout, prior),
        )
        if found is None:
            return None
        samples = found.samples
        return ShapeLikelihood(
            samples.point,
            samples.origin,
            samples.axes,
            found.log_likelihood,
            found.flux,
            found.flux_variance,
        )
