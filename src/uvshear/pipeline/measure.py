"""The measurement on one page: visibilities and a catalogue in, shapes out.

1. Read the observation once: the lengths of its baselines, the map of its weights, and what a user must know of the
   data before any work is done (``interferometer.first_pass``).
2. Begin with a sky of round galaxies of the catalogue's fluxes and of median size (``pipeline.field``).
3. Apply weightings other than the natural one, if any are asked for (``extraction.weighted_shapes``).
4. Tell the sources apart and measure each without the others (``extraction``).
5. Quote the signal-to-noise ratios of natural weights (``diagnostics.natural_snr``).
6. Tabulate (``pipeline.tabulate``).
"""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from uvshear.diagnostics.natural_snr import with_natural_snr
from uvshear.errors import DataWarning
from uvshear.estimators.registry import EstimatorLike, estimators_of
from uvshear.execution import Resources
from uvshear.extraction import Extracted, Field, MeasurementOptions, Method, Model
from uvshear.extraction.weighted_shapes import weigh
from uvshear.interferometer.first_pass import FirstPass, first_pass
from uvshear.interferometer.summary import summarise
from uvshear.interferometer.visibilities import Observation
from uvshear.io.observations import open_observation
from uvshear.io.provenance import Provenance
from uvshear.io.statistics import statistics_table
from uvshear.pipeline.catalogue import CatalogueLike, catalogue_of
from uvshear.pipeline.field import field_of_catalogue
from uvshear.pipeline.measurement import MeasuredField, Measurement
from uvshear.pipeline.tabulate import catalogue_of_sky, tabulate_shapes
from uvshear.predict.response import Response
from uvshear.progress import Progress

ObservationLike: TypeAlias = Observation | str | Path | Sequence[str | Path]
"""An observation, or the file or files that have it."""


def measure(
    observation: ObservationLike,
    catalogue: CatalogueLike,
    *,
    keep: EstimatorLike | Sequence[EstimatorLike] = (),
    model: Model | None = None,
    method: Method | None = None,
    resources: Resources | None = None,
    progress: Progress | None = None,
) -> Measurement:
    """Measure the shape of every source of a catalogue.

    Parameters
    ----------
    observation
        Visibilities of one pointing, or the path or paths of the files that have them.
    catalogue
        Sources that are in the field, to be measured or to be subtracted.
    keep
        Estimators of the shear whose statistics are kept beside the shapes: names joined by commas, or a sequence of
        names and estimators.
    model
        What is believed of the galaxies and the dishes.
    method
        How shapes are measured.
    resources
        What may be used of the machine.
    progress
        Called with what is done and what there is.

    Raises
    ------
    InputError
        An input is wrong. What goes wrong with a source is a flag in its row (``shapes.measurement.FitFlag``).

    Warns
    -----
    DataWarning
        There is something about the data that a user should know; told before the work starts.
    """
    # The shapes themselves are all that some estimators need.
    kept = tuple(estimator for estimator in estimators_of(keep) if estimator.columns)
    options = MeasurementOptions(
        model or Model(), method or Method(), resources or Resources(), kept
    )
    sources = catalogue_of(catalogue)
    seen = open_observation_of(observation)
    first = first_pass(seen, options.resources.executor)
    for text in first.warnings:
        warnings.warn(text, DataWarning, stacklevel=2)
    field = field_of_catalogue(
        sources, seen.phase_centre, first.summary, options.model, options.method
    )
    extracted = _extract(seen, field, first, options, progress)
    shapes = tabulate_shapes(sources, field, extracted, seen.phase_centre, options.model)
    made = Provenance("uvshear.measure", _names(observation, catalogue))
    shapes.meta.update(made.metadata())
    return Measurement(
        shapes=shapes,
        statistics=statistics_table(shapes, kept, extracted.kept) if kept else None,
        sky=catalogue_of_sky(sources, field, extracted, seen.phase_centre),
        record=extracted.record,
        field=MeasuredField(seen, first.summary, extracted.uv_range, options),
    )


def open_observation_of(observation: ObservationLike) -> Observation:
    """Return the observation itself, or open the file or files that have it."""
    if isinstance(observation, Observation):
        return observation
    return open_observation(observation)


def _extract(
    observation: Observation,
    field: Field,
    first: FirstPass,
    options: MeasurementOptions,
    progress: Progress | None,
) -> Extracted:
    """Measure the sources; signal-to-noise ratios are those of natural weights, whatever weights shapes are taken with."""
    method, model = options.method, options.model
    seen, among = observation, field
    if method.weightings and len(field.measured):
        seen, correction = weigh(observation, field, options)
        among = replace(field, summary=summarise(seen), weight_correction=correction)
    extracted = method.extraction.extract(seen, among, options.setting, progress)
    is_part = extracted.uv_range.minimum > 0 or method.uv_range.maximum < np.inf
    if not (is_part or method.weightings):
        return extracted
    attenuation = model.attenuation(observation.phase_centre.dec)
    if not method.extraction.models_attenuation:
        attenuation = None
    response = Response.from_sky(
        field.sky.select(field.modelled), first.summary.probes, attenuation
    )
    quoted = with_natural_snr(
        extracted.measurements,
        first.baselines,
        extracted.sky,
        model.profile,
        response=response,
        executor=options.resources.executor,
    )
    return replace(extracted, measurements=quoted)


def _names(observation: ObservationLike, catalogue: CatalogueLike) -> tuple[str, ...]:
    """Names of the inputs that are files."""
    paths = (
        [observation]
        if isinstance(observation, str | Path)
        else list(observation)
        if isinstance(observation, Sequence)
        else []
    )
    return tuple(str(path) for path in (*paths, catalogue) if isinstance(path, str | Path))
