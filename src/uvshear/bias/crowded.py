"""Bias in a crowded field: the same galaxies with the same noise, observed and measured with each shear."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from uvshear.bias.fit import TermSums, fit_bias, shears_from_sums
from uvshear.errors import InputError
from uvshear.estimators import Bias, Estimator, Sample
from uvshear.estimators.estimate import sky_terms, within_reach
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.estimators.terms import shear_in_field_frame
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Exponential, Galaxies, Profile
from uvshear.geometry.directions import local_north
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.pipeline.measurement import Measurement
from uvshear.pipeline.sample import sample_of, selected
from uvshear.pipeline.simulate import Lens
from uvshear.predict import predict_visibilities
from uvshear.progress import Meter, Progress, Stage
from uvshear.simulation.lensing import shear_galaxies
from uvshear.typing import Array, Bool, Float, Int

BLOCKS = 7
"""Number of blocks of the jackknife along l and along m."""

ROUNDS = 2
"""Number of iterations of the expansion about the estimate of the shear."""

Measure = Callable[[VisibilitySet, Galaxies, Progress | None], Measurement]
"""Function that measures an observation, with the positions and fluxes of these galaxies as the catalogue, and reports
its progress."""


@dataclass(frozen=True)
class FieldExperiment:
    """A field of galaxies, the noise of its observation, and the shears.

    Parameters
    ----------
    galaxies
        Galaxies before they are lensed.
    noise
        Visibilities of noise alone, with their weights.
    shears
        Reduced shears in the frame of the sky, which add up to zero.
    used
        Mask of the galaxies that enter the bias; the others are only observed and subtracted.
    lens
        Function that applies a shear to galaxies.
    profile
        Brightness profile of the galaxies.
    executor
        Executor of the prediction.
    """

    galaxies: Galaxies
    noise: VisibilitySet
    shears: tuple[complex, ...]
    used: Bool[Array, " source"]
    lens: Lens = shear_galaxies
    profile: Profile = field(default_factory=Exponential)
    executor: Executor = SERIAL

    def lensed(self, shear: complex, ellipticity_sign: int) -> Galaxies:
        """Return the galaxies with a shear, and with their intrinsic ellipticities multiplied by the sign."""
        galaxies = replace(self.galaxies, ellipticity=ellipticity_sign * self.galaxies.ellipticity)
        north = local_north(self.noise.phase_centre, galaxies.l, galaxies.m)
        return self.lens(galaxies, shear_in_field_frame(shear, north))

    def observed(self, galaxies: Galaxies, noise_sign: int) -> VisibilitySet:
        """Return the observation of lensed galaxies, with its noise multiplied by the sign."""
        blocks = []
        for block in self.noise.blocks:
            model = predict_visibilities(
                galaxies, block.uvw, block.frequency, self.profile, self.executor
            )
            data = (model + noise_sign * block.stokes_i).astype(np.complex64)
            blocks.append(replace(block, stokes_i=data))
        return VisibilitySet(self.noise.phase_centre, tuple(blocks))


def estimate_crowded_bias(
    experiment: FieldExperiment,
    estimators: Sequence[Estimator],
    measure: Measure,
    progress: Progress | None = None,
) -> list[Bias]:
    """Estimate the bias of each estimator, in total and by flux, from the galaxies that every measurement contains."""
    for estimator in estimators:
        if estimator.is_learning:
            raise InputError(
                f"the estimator '{estimator.name}' fits its population to a sample, which is possible only for isolated"
                " galaxies; leave out the density, or give the estimator a population"
            )
    shears = experiment.shears
    measured: list[list[Measurement]] = []
    meter, count = Meter(progress), 4 * len(shears)
    fields = [Stage(f"field {k + 1} of {count}", 1.0, 1.0, kind="field") for k in range(count)]
    for shear in shears:
        found: list[Measurement] = []
        for ellipticity_sign in (1, -1):
            lensed = experiment.lensed(shear, ellipticity_sign)
            for noise_sign in (1, -1):
                meter.begin(*fields)
                observed = experiment.observed(lensed, noise_sign)
                found.append(measure(observed, lensed, meter.reach))
                meter.reach(1, 1)
                del fields[0]
        measured.append(found)
    return [_bias(experiment, estimator, measured) for estimator in estimators]


def _bias(
    experiment: FieldExperiment,
    estimator: Estimator,
    measured: Sequence[Sequence[Measurement]],
) -> Bias:
    samples = [
        [(sample_of(field, estimator), selected(field.shapes)) for field in found]
        for found in measured
    ]
    about = [0j] * len(experiment.shears)
    for _ in range(ROUNDS if estimator.is_expanded else 1):
        expanded_about = about
        terms = np.array(
            [
                [_terms(estimator, sample, is_ok, g) for sample, is_ok in found]
                for g, found in zip(about, samples, strict=True)
            ]
        )
        good = np.isfinite(terms).all(axis=(0, 1, 3)) & experiment.used
        sums = terms[:, :, good].sum(axis=(1, 2))
        about = [within_reach(complex(*g)) for g in shears_from_sums(sums, about)]
    return _by_flux(experiment, terms.sum(axis=1), good, expanded_about)


def _terms(
    estimator: Estimator, sample: Sample, is_ok: Bool[Array, " source"], about: complex
) -> Float[Array, "source 6"]:
    """Return two numbers and four of their response for every source; NaN where a source was not measured."""
    rows = np.full((len(sample), 6), np.nan)
    terms = sky_terms(estimator, sample.select(is_ok), about)
    rows[is_ok] = np.concatenate([terms.value, terms.response.reshape(-1, 4)], axis=1)
    return rows


def _by_flux(
    experiment: FieldExperiment,
    terms: Float[Array, "shear source 6"],
    good: Bool[Array, " source"],
    about: Sequence[complex],
) -> Bias:
    galaxies = experiment.galaxies
    rank = [np.argsort(np.argsort(x)) * BLOCKS // len(galaxies) for x in (galaxies.l, galaxies.m)]
    block = rank[0] * BLOCKS + rank[1]
    used = experiment.used

    def sums_of(inside: Bool[Array, " source"]) -> TermSums:
        return _sums(terms, block, used & inside & good, int((used & inside & ~good).sum()))

    total = sums_of(np.ones(len(galaxies), bool))
    bins = {flux_bin.name: sums_of(flux_bin.holds(galaxies.flux)) for flux_bin in FLUX_BINS}
    return fit_bias(total, bins, experiment.shears, about)


def _sums(
    terms: Float[Array, "shear source 6"],
    block: Int[Array, " source"],
    chosen: Bool[Array, " source"],
    failed: int,
) -> TermSums:
    values = np.zeros((BLOCKS**2, len(terms), 6))
    np.add.at(values, block[chosen], terms[:, chosen].swapaxes(0, 1))
    return TermSums(values, int(chosen.sum()), failed)
