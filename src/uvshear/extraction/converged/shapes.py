"""The shapes of all galaxies of a converged sky: posteriors, with the neighbours marginalised."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from uvshear.execution import Executor
from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.neighbour_marginalisation import (
    NeighbourMarginalisation,
    NeighbourMarginaliser,
)
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.extraction.state_store import Results
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
    known: Results[ShapeMeasurement] | None = None,
) -> Mapping[int, ShapeMeasurement]:
    """Sample the posterior of every galaxy; the results are by index of the catalogue, in its fluxes.

    Posteriors that are known already, by the number of the galaxy among the modelled sources, are not sampled again;
    the others are added to them.
    """
    galaxies = modelled.galaxies
    unit_of = {source: unit for unit in state.neighbourhood.units for source in unit}
    marginaliser = NeighbourMarginaliser.from_state(state)
    subject = _Measured(state, modelled, history, marginaliser, unit_of)
    known = Results() if known is None else known
    left = [k for k in galaxies if k not in known]
    shapes = executor.distribute(_measure_one, subject, left)
    for k, shape in zip(left, shapes, strict=True):
        on_shape()
        known.add(k, shape)
    return {
        int(modelled.field.modelled[k]): _in_catalogue_flux(known[k], modelled, k) for k in galaxies
    }


@dataclass(frozen=True)
class _Measured:
    """What the shapes of all galaxies are measured from; ``unit_of`` gives the sources that are fitted with each."""

    state: SkyState
    modelled: ModelledField
    history: History
    marginaliser: NeighbourMarginaliser | None
    unit_of: Mapping[int, list[int]]

    def remaining_change(self, k: int) -> RemainingChange:
        """Return what another major cycle would change, judging by what the last one changed."""
        state, history = self.state, self.history
        change = history.shrinkage * state.change_of_unit(self.unit_of[k], state.subtracted)
        step = state.fits[k].ellipticity - state.subtracted[k].ellipticity
        return RemainingChange(change, history.left_to_the_limit * step)


def _measure_one(subject: _Measured, k: int) -> ShapeMeasurement:
    modelled, marginaliser = subject.modelled, subject.marginaliser
    correction = float(modelled.field.weight_correction[modelled.field.modelled[k]])
    neighbours = None if marginaliser is None else marginaliser.marginalise(k)
    shape = _measure(subject.state, k, neighbours, correction)
    return with_remaining_change(shape, subject.remaining_change(k))


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


def _in_catalogue_flux(
    shape: ShapeMeasurement, modelled: ModelledField, source: int
) -> ShapeMeasurement:
    strength = float(modelled.strength[source])
    best = None if shape.best is None else modelled.in_catalogue_flux(source, shape.best)
    return replace(shape, flux=shape.flux / strength, flux_err=shape.flux_err / strength, best=best)
