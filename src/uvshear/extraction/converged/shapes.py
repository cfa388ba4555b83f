"""The shapes of all galaxies of a converged sky: posteriors, with the neighbours marginalised."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

from uvshear.execution import Executor
from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.neighbour_marginalisation import (
    NeighbourMarginalisation,
    marginalise_all,
)
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.neighbours import with_neighbours_marginalised
from uvshear.shapes.residual_significance import SIGNIFICANT, residual_significance
from uvshear.shapes.shape import measure_shape


def measure_shapes(
    state: SkyState,
    modelled: ModelledField,
    executor: Executor,
    on_shape: Callable[[], None],
) -> Mapping[int, ShapeMeasurement]:
    """Sample the posterior of every galaxy; the results are by index of the catalogue, in its fluxes."""
    galaxies = modelled.galaxies
    neighbours = dict(zip(galaxies, marginalise_all(state, galaxies), strict=True))

    def measure(k: int) -> ShapeMeasurement:
        correction = float(modelled.field.weight_correction[modelled.field.modelled[k]])
        return _measure(state, k, neighbours[k], correction)

    measurements = {}
    for k, shape in zip(galaxies, executor.map(measure, galaxies), strict=True):
        on_shape()
        source = int(modelled.field.modelled[k])
        measurements[source] = _in_catalogue_flux(shape, modelled, k)
    return measurements


def _measure(
    state: SkyState,
    source: int,
    neighbours: NeighbourMarginalisation | None,
    weight_correction: float,
) -> ShapeMeasurement:
    prior, fit, profile = state.sources[source].prior, state.fits[source], state.profile
    fraction = 1.0 if neighbours is None else neighbours.information_fraction
    shape = measure_shape(
        state.facet(source),
        prior.measured,
        profile,
        fit if fit.snr > 0 else None,
        information_fraction=fraction * weight_correction,
    )
    if shape.flag is FitFlag.OK:
        size = math.exp(prior.log_scale_length)
        if residual_significance(state.residual(source), profile, size) > SIGNIFICANT:
            shape = replace(shape, flag=FitFlag.CONTAMINATED)
    if neighbours is None:
        return shape
    conditional = neighbours.conditional / weight_correction
    marginal = neighbours.marginal / weight_correction
    return with_neighbours_marginalised(shape, conditional, marginal, neighbours.shift, fraction)


def _in_catalogue_flux(
    shape: ShapeMeasurement, modelled: ModelledField, source: int
) -> ShapeMeasurement:
    strength = float(modelled.strength[source])
    best = None if shape.best is None else modelled.in_catalogue_flux(source, shape.best)
    return replace(shape, flux=shape.flux / strength, flux_err=shape.flux_err / strength, best=best)
