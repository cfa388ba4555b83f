"""The bias of an estimator of the shear on simulated galaxies."""

import cmath
import math
import warnings
from collections.abc import Sequence
from dataclasses import replace

from uvshear.bias.crowded import estimate_crowded_bias
from uvshear.bias.isolated import estimate_isolated_bias
from uvshear.bias.survey import Survey
from uvshear.errors import DataWarning
from uvshear.estimators import Bias, Estimator, estimator_of
from uvshear.estimators.bias import BiasSimulation
from uvshear.estimators.registry import EstimatorLike
from uvshear.estimators.shear_estimate import ShearConditions
from uvshear.execution import Resources
from uvshear.galaxy import Galaxies
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.pipeline.measure import measure
from uvshear.pipeline.measurement import Measurement
from uvshear.progress import Meter, Progress, Stage
from uvshear.simulation.lensing import shear_at_fixed_scale_length


def estimate_bias(
    estimator: EstimatorLike,
    *,
    galaxies: int,
    shear: float | Sequence[complex] = 0.02,
    seed: int = 1,
    survey: Survey | None = None,
    density: float | None = None,
    resources: Resources | None = None,
    progress: Progress | None = None,
) -> Bias:
    """Estimate the bias m and c of an estimator, in total and by flux, in the frame of the sky.

    Parameters
    ----------
    estimator
        Estimator of the shear, or its name.
    galaxies
        Number of galaxies. Each isolated galaxy is measured four times with each shear (twice without rings), or eight
        times in all if the shear is zero.
    shear
        Modulus of two opposite shears with g1 = g2, or a sequence of shears g1 + i g2 that add up to zero. With 0 only
        the additive bias is estimated.
    seed
        Seed of galaxies and noise.
    survey
        The observation and the galaxies that are counted; an SKA-Mid track of 8 h and the paper's population unless
        given.
    density
        Number of galaxies per square arcminute in a crowded field, in which all of them are measured together; None
        measures isolated galaxies.
    resources
        Workers and memory of the machine that may be used.
    progress
        Function called with the work done so far and the total work.
    """
    resources = resources or Resources()
    method = estimator_of(estimator)
    known = survey or Survey.of_the_paper()
    shears = opposite_shears(shear) if isinstance(shear, int | float) else tuple(shear)
    simulation = _simulation(method, known, shears, density, seed)
    Meter.of_stages(progress).begin(Stage("preparation"))
    if density is None:
        experiment = known.isolated(shears, seed, resources.executor)
        bias = estimate_isolated_bias(experiment, method, galaxies, resources.executor, progress)
        return replace(bias, simulation=simulation)

    def measured(
        observation: VisibilitySet, lensed: Galaxies, of_field: Progress | None
    ) -> Measurement:
        catalogue = catalogue_from_galaxies(lensed, observation.phase_centre)
        with warnings.catch_warnings():
            # Simulated weights are right; a coarse track may make the scatter of neighbouring samples look otherwise.
            warnings.simplefilter("ignore", DataWarning)
            return measure(
                observation, catalogue, keep=(method,), resources=resources, progress=of_field
            )

    crowd = known.crowd(shears, galaxies, density, seed, resources.executor)
    (bias,) = estimate_crowded_bias(crowd, [method], measured, progress)
    return replace(bias, simulation=simulation)


def _simulation(
    estimator: Estimator,
    survey: Survey,
    shears: tuple[complex, ...],
    density: float | None,
    seed: int,
) -> BiasSimulation:
    is_measured = survey.measured_snr_min > 0
    return BiasSimulation(
        ShearConditions(
            estimator.name,
            estimator.record(),
            survey.measured_snr_min if is_measured else survey.snr_min,
            survey.flux_min,
            survey.averages_cells,
        ),
        cuts_on_measured=is_measured,
        flux_max=survey.flux_max,
        keeps_scale_lengths=survey.lens is shear_at_fixed_scale_length,
        position_sigma=survey.position_sigma,
        shears=shears,
        density=density,
        seed=seed,
    )


def opposite_shears(modulus: float, orientations: int = 2) -> tuple[complex, ...]:
    """Return shears of one modulus in equally spaced directions, the first at 22.5 deg; a single zero for modulus 0."""
    angles = [math.pi / 4 + 2 * math.pi * k / orientations for k in range(orientations)]
    return tuple(cmath.rect(modulus, angle) for angle in angles) if modulus else (0j,)
