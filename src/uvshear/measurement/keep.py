"""What is kept of every source beside its shape, for estimators of the shear that need more."""

import math
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

Kept = Mapping[str, float | Array]
"""Of a source: a number or a one-dimensional array a column."""

SourceName = tuple[int, ...]
"""Numbers that tell a source from all others, of other fields too: from them comes what is drawn for it."""

_LONGEST = 1.5 * REACH * SCALE
"""Baselines that the weights of moments may reach [wavelengths], whatever the error of the position."""


class Statistic(ABC):
    """Numbers of a source, from the facet that its shape is measured on."""

    columns: tuple[str, ...]

    @abstractmethod
    def of(self, facet: Facet, cutout: Cutout, prior: ShapePrior, name: SourceName) -> Kept:
        """Work out the value of each column, for a source of this prior; nothing where there is none."""


class MomentStatistic(Statistic):
    """Moments of the visibility function about the catalogue's position, with their responses and noise [Jy]."""

    columns = ("m1", "m2", "m_size", "r11", "r12", "r22", "r_third", "m1_var", "m2_var", "m12_cov")

    def __init__(self, position_sigma: float = 0.0) -> None:
        """``position_sigma`` is the error of the catalogue's position in l and in m [rad]."""
        self._position_sigma = position_sigma
        self._known: dict[tuple[int, float, tuple[float, ...]], tuple[float, MomentFunctional]] = {}

    def of(
        self, facet: Facet, cutout: Cutout, prior: ShapePrior, name: SourceName
    ) -> Mapping[str, float]:
        """Measure them; no prior has a part in it."""
        # Sources of one size and one beam share its power, all but for long baselines that moments do not take.
        longest = min(cutout.longest, _LONGEST)
        facet = facet.within(longest)
        total, shape = facet.beam_shape()
        key = cutout.size, longest, shape
        if key not in self._known:
            width = cutout.size * cutout.pixel
            power = np.asarray(facet.power, float)
            self._known[key] = (
                total,
                MomentFunctional(facet.uv, power, width, self._position_sigma),
            )
        known_total, functional = self._known[key]
        # Weights are those of a facet whose unit of flux may be another.
        unit = math.sqrt(total / known_total) if known_total > 0 else 1.0
        moments = functional.measure(facet.correlation / unit**2)
        covariance = moments.covariance / unit**2
        return {
            "m1": float(moments.shape[0]),
            "m2": float(moments.shape[1]),
            "m_size": moments.size,
            "r11": float(moments.response[0, 0]),
            "r12": float(moments.response[0, 1]),
            "r22": float(moments.response[1, 1]),
            "r_third": moments.third,
            "m1_var": float(covariance[0, 0]),
            "m2_var": float(covariance[1, 1]),
            "m12_cov": float(covariance[0, 1]),
        }


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

    def of(self, facet: Facet, cutout: Cutout, prior: ShapePrior, name: SourceName) -> Kept:
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
