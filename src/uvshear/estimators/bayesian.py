"""Shear from the likelihood of each galaxy's shape, for a population of galaxies behind a lens."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar, Final, Self

import numpy as np

from uvshear.estimators.estimator import Estimator
from uvshear.estimators.evidence import gradient_and_curvature
from uvshear.estimators.packing import PACKED, Packed, is_whole, pack, unpack
from uvshear.estimators.population import UnlensedPopulation
from uvshear.estimators.population_fit import (
    FittedPopulation,
    fit_population,
    parameter_count,
    population_scores,
)
from uvshear.estimators.sample import Sample
from uvshear.estimators.shape_likelihood import ShapeLikelihood
from uvshear.estimators.terms import Terms, shear_in_field_frame
from uvshear.galaxy import Profile
from uvshear.progress import Meter
from uvshear.shapes.interpolative import DecompositionCache
from uvshear.shapes.likelihood import sample_likelihood
from uvshear.shapes.source_facet import Column, Kept, SourceFacet
from uvshear.shapes.statistic_flag import StatisticFlag
from uvshear.typing import Array, Bool, Complex, Float

LIKELIHOOD: Final = "likelihood"
"""Column of a simulated sample that holds likelihoods without packing."""


@dataclass(frozen=True)
class Bayesian(Estimator):
    """Most probable shear for a population of galaxies, given the likelihood of each galaxy's shape.

    It has no noise bias if the population is the right one (``estimators.evidence`` has the mathematics).

    Parameters
    ----------
    population
        Distributions of flux, size and ellipticity of unlensed galaxies; those of the paper unless given.
    fits_population
        Whether the distributions of size and ellipticity are first fitted to the sample itself.
    fitted
        The fitted population with its covariance; None unless it was fitted.
    """

    population: UnlensedPopulation = field(default_factory=UnlensedPopulation)
    fits_population: bool = False
    fitted: FittedPopulation | None = None
    _caches: dict[Profile, DecompositionCache] = field(
        default_factory=dict, repr=False, compare=False
    )

    name = "bayesian"
    nanoseconds = 22e6
    columns: ClassVar = {
        "lattice": Column(
            "origin of the lattice in (e1, e2, ln(scale length/rad)), and its axes, row by row"
        ),
        "columns": Column(
            "three coordinates of the lowest node, and the number of nodes, for each column of the lattice"
        ),
        "log_likelihood": Column(
            "maximum of the log likelihood minus its value, in units of 0.001, at the nodes of one column of the"
            " lattice after another"
        ),
        "flux_terms": Column("coefficients of the polynomial for the flux at each node", "Jy"),
        "variance_terms": Column(
            "coefficients of the polynomial for ln(variance of the flux / Jy2) at each node"
        ),
    }
    is_expanded = True

    def statistic(self, source: SourceFacet) -> Kept | StatisticFlag:
        """Sample the likelihood and pack it into a few kilobytes."""
        if not source.facet.has_power:
            return StatisticFlag.NO_DATA
        likelihood = self._likelihood(source)
        return StatisticFlag.NOT_FITTED if likelihood is None else pack(likelihood)

    def numbers(self, source: SourceFacet) -> Mapping[str, object] | None:
        """Sample the likelihood without packing it, which would take another 7 per cent of the time."""
        likelihood = self._likelihood(source)
        return None if likelihood is None else {LIKELIHOOD: likelihood}

    def _likelihood(self, source: SourceFacet) -> ShapeLikelihood | None:
        """Sample the likelihood of a source over all shapes that the population contains."""
        profile = source.profile
        cache = self._caches.setdefault(profile, DecompositionCache(profile))
        found = sample_likelihood(
            source.facet,
            source.prior,
            profile,
            self.population.ellipticity,
            cache.maker_for(source.facet, source.cells, source.prior),
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

    def damaged(self, sample: Sample) -> Bool[Array, " source"]:
        """Tell which sources have a packed likelihood that none was packed into."""
        if LIKELIHOOD in sample.columns:
            return super().damaged(sample)
        return np.array([not (_is_empty(row) or is_whole(row)) for row in _packed(sample)], bool)

    def terms(self, sample: Sample, about: Complex[Array, " source"]) -> Terms:
        """Return the gradient and the curvature of the log probability of each galaxy's data.

        Both are zero for a galaxy that does not occur in the population.
        """
        value = np.full((len(sample), 2), np.nan)
        response = np.full((len(sample), 2, 2), np.nan)
        for k, likelihood in enumerate(likelihoods_of(sample)):
            if likelihood is not None:
                value[k], response[k] = gradient_and_curvature(
                    likelihood, self.population, complex(about[k])
                )
        return Terms(value, response)

    def scores(
        self, sample: Sample, about: Complex[Array, " source"]
    ) -> Float[Array, "source parameter"]:
        """Return the gradients by the parameters of the population; none by those of a fitted one."""
        if self.fitted is not None:
            return np.zeros((len(sample), 0))
        found = np.full((len(sample), parameter_count(self.population)), np.nan)
        for k, likelihood in enumerate(likelihoods_of(sample)):
            if likelihood is not None:
                pair = (likelihood, complex(about[k]))
                found[k] = population_scores([pair], self.population, Meter(None))[0]
        return found

    @property
    def is_learning(self) -> bool:
        """Whether the population is yet to be fitted to the sample."""
        return self.fits_population

    def trained(self, sample: Sample, about: complex, meter: Meter | None = None) -> Self:
        """Return the estimator with the population fitted to a sample of sheared galaxies."""
        pairs = [
            (likelihood, shear)
            for likelihood, shear in zip(
                likelihoods_of(sample),
                shear_in_field_frame(about, sample.local_north).tolist(),
                strict=True,
            )
            if likelihood is not None
        ]
        found = fit_population(pairs, self.population, meter)
        return replace(self, population=found.population, fits_population=False, fitted=found)

    @property
    def prior(self) -> str:
        """Origin of the population: "paper", "fitted" to the sample, or "file" for any other."""
        if self.fits_population or self.fitted is not None:
            return "fitted"
        return "paper" if self.population == UnlensedPopulation() else "file"

    def record(self) -> dict[str, object]:
        """Return the population, with the standard errors of the parameters that were fitted."""
        population = self.population if self.fitted is None else self.fitted
        return {"prior": self.prior, "population": population.record()}


def likelihoods_of(sample: Sample) -> list[ShapeLikelihood | None]:
    """Return the likelihoods of a sample, unpacked if need be; None where a source has none."""
    if LIKELIHOOD in sample.columns:
        return list(sample[LIKELIHOOD])
    return [None if _is_empty(row) else unpack(row) for row in _packed(sample)]


def _packed(sample: Sample) -> Iterator[Packed]:
    rows = zip(*(sample[name] for name in PACKED), strict=True)
    return (dict(zip(PACKED, map(np.asarray, row), strict=True)) for row in rows)


def _is_empty(row: Packed) -> bool:
    """Tell a source without a likelihood, which has empty arrays, or NaN in a table in which no source has one."""
    return all(_has_no_number(part) for part in row.values())


def _has_no_number(part: Array) -> bool:
    return part.size == 0 or (part.ndim == 0 and part.dtype.kind == "f" and bool(np.isnan(part)))
