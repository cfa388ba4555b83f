"""The shapes of all galaxies of a converged sky: posteriors, with the neighbours marginalised."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from uvshear.execution import Executor
from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.neighbour_marginalisation import (
    NeighbourMarginalisation,
    marginalise_all,
)
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.neighbours import with_neighbours_marginalised
from uvshear.shapes.remaining_change import RemainingChange, with_remaining_change
from uvshear.shapes.residual_significance import SIGNIFICANT, residual_significance
from uvshear.shapes.shape import measure_shape
from uvshear.shapes.significance import with_significance


def measure_shapes(
    state: SkyState,
    modelled: ModelledField,
    history: History,
    executor: Executor,
    on_shape: Callable[[], None],
) -> Mapping[int, ShapeMeasurement]:
    """Sample the posterior of every galaxy; the results are by index of the catalogue, in its fluxes."""
    galaxies = modelled.galaxies
    remaining = _remaining_changes(state, history)
    neighbours = dict(zip(galaxies, marginalise_all(state, galaxies), strict=True))

    subject = _Measured(state, modelled, remaining, neighbours)
    measurements = {}
    shapes = executor.distribute(_measure_one, subject, galaxies)
    for k, shape in zip(galaxies, shapes, strict=True):
        on_shape()
        source = int(modelled.field.modelled[k])
        measurements[source] = _in_catalogue_flux(shape, modelled, k)
    return measurements


@dataclass(frozen=True)
class _Measured:
    """What the shapes of all galaxies are measured from."""

    state: SkyState
    modelled: ModelledField
    remaining: Sequence[RemainingChange]
    neighbours: Mapping[int, NeighbourMarginalisation | None]


def _measure_one(subject: _Measured, k: int) -> ShapeMeasurement:
    modelled = subject.modelled
    correction = float(modelled.field.weight_correction[modelled.field.modelled[k]])
    shape = _measure(subject.state, k, subject.neighbours[k], correction)
    return with_remaining_change(shape, subject.remaining[k])


def _measure(
    state: SkyState,
    source: int,
    neighbours: NeighbourMarginalisation | None,
    weight_correction: float,
) -> ShapeMeasurement:
    prior, fit, profile = state.sources[source].prior, state.fits[source], state.profile
    fraction = 1.0 if neighbours is None else neighbours.information_fraction
    facet = state.facet(source)
    shape = measure_shape(
        facet,
        prior.measured,
        profile,
        fit if fit.snr > 0 else None,
        information_fraction=fraction * weight_correction,
    )
    shape = with_significance(shape, facet, prior.measured, profile, weight_correction)
    if shape.flag in (FitFlag.OK, FitFlag.UNRESOLVED):
        size = math.exp(prior.log_scale_length)
        if residual_significance(state.residual(source), profile, size) > SIGNIFICANT:
            shape = replace(shape, flag=FitFlag.CONTAMINATED)
    quality = replace(shape.quality, error_widening=1 / math.sqrt(fraction))
    shape = replace(shape, quality=quality)
    if neighbours is None:
        return shape
    conditional = neighbours.conditional / weight_correction
    marginal = neighbours.marginal / weight_correction
    return with_neighbours_marginalised(shape, conditional, marginal, neighbours.shift, fraction)


def _remaining_changes(state: SkyState, history: History) -> list[RemainingChange]:
    """Return what another major cycle would change, judging by what the last one changed."""
    change = history.shrinkage * state.change_since(state.subtracted)
    further = history.left_to_the_limit
    return [
        RemainingChange(float(model), further * (now.ellipticity - before.ellipticity))
        for model, now, before in zip(change, state.fits, state.subtracted, strict=True)
    ]


def _in_catalogue_flux(
    shape: ShapeMeasurement, modelled: ModelledField, source: int
) -> ShapeMeasurement:
    strength = float(modelled.strength[source])
    best = None if shape.best is None else modelled.in_catalogue_flux(source, shape.best)
    return replace(shape, flux=shape.flux / strength, flux_err=shape.flux_err / strength, best=best)
