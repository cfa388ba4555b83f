"""Shear from the likelihoods of the shapes of a population behind a lens."""

from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from uvshear.estimators.estimator import Estimator
from uvshear.estimators.evidence import gradient_and_curvature
from uvshear.estimators.packing import PACKED, pack, unpack
from uvshear.estimators.population import UnlensedPopulation
from uvshear.estimators.population_fit import FittedPopulation, fit_population
from uvshear.estimators.sample import Sample
from uvshear.estimators.shape_likelihood import ShapeLikelihood
from uvshear.estimators.terms import Terms, shear_in_field_frame
from uvshear.galaxy import Profile
from uvshear.progress import Meter
from uvshear.shapes.interpolative import DecompositionCache
from uvshear.shapes.likelihood import sample_likelihood
from uvshear.shapes.source_facet import Column, Kept, SourceFacet
from uvshear.typing import Array, Complex


@dataclass(frozen=True)
class Bayesian(Estimator):
    """Shear at which galaxies of a population are most probable, from the likelihood of each galaxy's shape.

    It has no noise bias where the population is the right one (``estimators.evidence`` has the mathematics).

    Parameters
    ----------
    population
        Distributions of flux, size and ellipticity before the galaxies are lensed; those of the paper unless given.
    fits_population
        Whether size and ellipticity of the population are first fitted to the sample itself.
    fitted
        The population that was fitted, with its covariance; None before.
    """

    population: UnlensedPopulation = field(default_factory=UnlensedPopulation)
    fits_population: bool = False
    fitted: FittedPopulation | None = None
    _caches: dict[Profile, DecompositionCache] = field(
        default_factory=dict, repr=False, compare=False
    )

    name = "bayesian"
    columns: ClassVar = {
        "lattice": Column(
            "origin of the lattice in (e1, e2, ln(scale length/rad)), and its axes by rows"
        ),
        "columns": Column(
            "three coordinates of the lowest node, and the number of nodes, of each column of the lattice"
        ),
        "log_likelihood": Column("thousandths below the highest log likelihood, column by column"),
        "flux_terms": Column("polynomial of the flux at each node", "Jy"),
        "variance_terms": Column("polynomial of the logarithm of the flux's variance / Jy2"),
    }
    is_expanded = True

    def statistic(self, source: SourceFacet) -> Kept | None:
        """Sample the likelihood wherever the population reaches, and pack it into a few kilobytes."""
        profile = source.profile
        if profile not in self._caches:
            self._caches[profile] = DecompositionCache(profile)
        cache = self._caches[profile]
        found = sample_likelihood(
            source.facet,
            source.prior,
            profile,
            self.population.ellipticity,
            lambda: cache.decomposition(source.facet, source.cells, source.prior),
        )
        if found is None:
            return None
        samples = found.samples
        return pack(
            ShapeLikelihood(
                samples.point,
                samples.origin,
                samples.axes,
                found.log_likelihood,
                found.flux,
                found.flux_variance,
            )
        )

    def terms(self, sample: Sample, about: Complex[Array, " source"]) -> Terms:
        """Gradient and curvature of the log probability of each galaxy's data.

        They are zero for a galaxy that the population does not have.
        """
        value = np.full((len(sample), 2), np.nan)
        response = np.full((len(sample), 2, 2), np.nan)
        for k, likelihood in enumerate(likelihoods_of(sample)):
            if likelihood is not None:
                value[k], response[k] = gradient_and_curvature(
                    likelihood, self.population, complex(about[k])
                )
        return Terms(value, response)

    @property
    def is_learning(self) -> bool:
        """Whether the population is fitted to the sample."""
        return self.fits_population

    def trained(self, sample: Sample, about: complex, meter: Meter | None = None) -> Self:
        """Fit the population to the galaxies of a sample behind a shear."""
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
        """Where the population comes from: "paper", "fitted" to the sample, or "file" for any other."""
        if self.fits_population or self.fitted is not None:
            return "fitted"
        return "paper" if self.population == UnlensedPopulation() else "file"

    def record(self) -> dict[str, object]:
        """Tell the population, with the errors of what was fitted of it."""
        population = self.population if self.fitted is None else self.fitted
        return {"prior": self.prior, "population": population.record()}


def likelihoods_of(sample: Sample) -> list[ShapeLikelihood | None]:
    """Unpack the likelihoods of a sample; None where a source has none."""
    rows = zip(*(sample[name] for name in PACKED), strict=True)
    packed = (dict(zip(PACKED, map(np.asarray, row), strict=True)) for row in rows)
    # A source without a likelihood has an empty array, and NaN in a table in which nobody has one.
    return [
        unpack(parts) if parts["lattice"].ndim and len(parts["lattice"]) else None
        for parts in packed
    ]
