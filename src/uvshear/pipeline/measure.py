"""The measurement on one page: visibilities and a catalogue in, shapes out.

1. Read the observation once: the lengths of its baselines, the map of its weights, and the checks of the data that
   lead to warnings (``interferometer.first_pass``).
2. Begin with a sky of round galaxies of the catalogue's fluxes and of median size (``pipeline.field``), and check the
   sign of UVW by it (``pipeline.data_checks``).
3. Apply weightings other than the natural one, if any are asked for (``extraction.weighted_shapes``).
4. Separate the sources and measure each with the others subtracted (``extraction``).
5. Compare the noise with the weights by the residual of the fitted sky (``pipeline.data_checks``).
6. Quote the signal-to-noise ratios of natural weights (``diagnostics.natural_snr``).
7. Tabulate (``pipeline.tabulate``).
"""

import warnings
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from uvshear.diagnostics.natural_snr import with_natural_snr
from uvshear.errors import DataWarning, InputError, NothingMeasuredWarning
from uvshear.estimators.registry import EstimatorLike, estimators_of
from uvshear.execution import Resources
from uvshear.extraction import Extracted, MeasurementOptions, Method, Model
from uvshear.extraction.state_store import NO_STORE, StateStore
from uvshear.extraction.weighted_shapes import weigh
from uvshear.interferometer.summary import summarise
from uvshear.io.checkpoint import Checkpoint
from uvshear.io.identifiers import check_identifiers
from uvshear.io.provenance import Provenance
from uvshear.io.statistics import statistics_table
from uvshear.pipeline.catalogue import CatalogueLike, catalogue_of
from uvshear.pipeline.identity import content_of, identity_of
from uvshear.pipeline.measurement import MeasuredField, Measurement
from uvshear.pipeline.observation import ObservationLike, observation_of, paths_of
from uvshear.pipeline.outcome import check_field, why_none_was_measured
from uvshear.pipeline.prepared import Prepared
from uvshear.pipeline.remarks import remarks
from uvshear.pipeline.tabulate import catalogue_of_sky, tabulate_shapes
from uvshear.predict.response import Response
from uvshear.progress import Progress

_EXTRACTED: Final = "extracted"


def measure(
    observation: ObservationLike,
    catalogue: CatalogueLike,
    *,
    keep: EstimatorLike | Sequence[EstimatorLike] = (),
    model: Model | None = None,
    method: Method | None = None,
    resources: Resources | None = None,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
) -> Measurement:
    """Measure the shape of every source of a catalogue.

    Parameters
    ----------
    observation
        Visibilities of one pointing, or the path or paths of the files that have them.
    catalogue
        Sources that are in the field, to be measured or to be subtracted.
    keep
        Estimators of the shear whose statistics are stored with the shapes: names separated by commas, or a sequence
        of names and estimators.
    model
        Assumptions about the galaxies and the dishes.
    method
        Algorithm of the measurement.
    resources
        Executor and memory.
    progress
        Function called with the work done so far and the total work, or an observer of the stages
        (``uvshear.progress.Observer``).
    checkpoint
        Where the state is stored while the measurement runs, so that another run can go on from it if this one is
        ended. It is removed when the measurement is written (``Measurement.write``).

    Raises
    ------
    InputError
        An input is wrong. A source that cannot be measured has a flag in its row instead
        (``shapes.measurement.FitFlag``).

    Warns
    -----
    DataWarning
        There is a problem in the data, or no galaxy could be measured. Warnings are issued before the work starts,
        except those that need the fitted sources.
    """
    _check_types(model, method, resources)
    # Some estimators need the shapes alone.
    kept = tuple(estimator for estimator in estimators_of(keep) if estimator.columns)
    options = MeasurementOptions(
        model or Model(), method or Method(), resources or Resources(), kept
    )
    sources = catalogue_of(catalogue)
    check_identifiers(sources.identifier)
    seen = observation_of(observation)
    store = None if checkpoint is None else checkpoint.opened(identity_of(seen, sources, options))
    prepared = Prepared.from_observation(seen, sources, options, progress)
    check_field(sources, prepared.observation.phase_centre, prepared.field.flags)
    checks, sky = prepared.checks, prepared.field.sky
    before = (
        *remarks("the weights", checks.weight_warnings),
        *remarks("the sign of UVW", lambda: checks.sign_warnings(sky)),
        *remarks("the unit of the catalogue's fluxes", lambda: checks.flux_warnings(sky)),
    )
    for text in (*prepared.first.warnings, *before):
        warnings.warn(text, DataWarning, stacklevel=2)
    with nullcontext() if store is None else store.in_use(content_of(prepared.first)):
        prepared, extracted = _extract_with_noise(prepared, progress, store or NO_STORE)
    fitted, uv_range = extracted.sky, extracted.uv_range
    checks = prepared.checks
    for text in remarks("the noise", lambda: checks.noise_warnings(fitted, uv_range)):
        warnings.warn(text, DataWarning, stacklevel=2)
    seen, field, first = prepared.observation, prepared.field, prepared.first
    shapes = tabulate_shapes(sources, field, extracted, seen.phase_centre, options.model)
    made = Provenance("uvshear.measure", (*paths_of(observation), *_path_of(catalogue)))
    shapes.meta.update(made.metadata())
    if cause := why_none_was_measured(shapes):
        warnings.warn(f"no galaxy was measured: {cause}", NothingMeasuredWarning, stacklevel=2)
    return Measurement(
        shapes=shapes,
        statistics=statistics_table(shapes, kept, extracted.kept) if kept else None,
        sky=catalogue_of_sky(sources, field, extracted, seen.phase_centre),
        record=extracted.record,
        field=MeasuredField(seen, first.summary, options.model, options.resources),
        checkpoint=store,
    )


def _extract_with_noise(
    prepared: Prepared, progress: Progress | None, store: StateStore
) -> tuple[Prepared, Extracted]:
    """Measure the sources; where the noise of the data is asked for, the weights are corrected to it before.

    The residual of the catalogue's sky tells the noise in most cases. If the residual of the fitted sky says otherwise,
    the sources are measured once more.
    """
    first_sky, uv_range = prepared.field.sky, prepared.field.uv_range
    prepared = prepared.with_noise_of_data(first_sky, uv_range, progress)
    extracted = _stored_extraction(prepared, progress, store.part("extraction"))
    corrected = prepared.with_noise_of_data(extracted.sky, extracted.uv_range, progress)
    if corrected is not prepared:
        prepared = corrected
        extracted = _stored_extraction(corrected, progress, store.part("second-extraction"))
    return prepared, extracted


def _stored_extraction(
    prepared: Prepared, progress: Progress | None, store: StateStore
) -> Extracted:
    """Measure the sources, unless their measurements are stored already."""
    found: Extracted | None = store.load(_EXTRACTED)
    if found is None:
        found = _extract(prepared, progress, store)
        store.save(_EXTRACTED, found)
    return found


def _check_types(model: object, method: object, resources: object) -> None:
    """Refuse arguments of the wrong type before anything is read."""
    for name, given, kind in (
        ("model", model, Model),
        ("method", method, Method),
        ("resources", resources, Resources),
    ):
        if given is not None and not isinstance(given, kind):
            raise InputError(
                f"{name}={given!r}: a uvshear.{kind.__name__} is needed, not the type {type(given).__name__}"
            )


def _extract(prepared: Prepared, progress: Progress | None, store: StateStore) -> Extracted:
    """Measure the sources; signal-to-noise ratios are those of natural weights, whatever the weights of the shapes."""
    observation, field, first = prepared.held, prepared.field, prepared.first
    options = prepared.options
    method, model = options.method, options.model
    seen, among = observation, field
    if method.weightings and len(field.measured):
        seen, correction = weigh(observation, field, options)
        among = replace(field, summary=summarise(seen), weight_correction=correction)
    extracted = method.extraction.extract(
        seen, among, replace(options.setting, store=store), progress
    )
    extracted = replace(extracted, record=_completed(extracted, method))
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


def _completed(extracted: Extracted, method: Method) -> dict[str, object]:
    """Return the record of an extraction with the facts that a residual image needs."""
    used = extracted.uv_range
    return dict(extracted.record) | {
        "uv_range": [used.minimum, used.maximum],
        "models_attenuation": method.extraction.models_attenuation,
    }


def _path_of(catalogue: CatalogueLike) -> tuple[str, ...]:
    return (str(catalogue),) if isinstance(catalogue, str | Path) else ()
