"""Estimation of a shear from a measurement."""

from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from astropy.table import Table

from uvshear.errors import InputError
from uvshear.estimators import ShearEstimate, estimate_sample_shear, estimator_of
from uvshear.estimators.bias_correction import BiasCorrection
from uvshear.estimators.registry import EstimatorLike
from uvshear.execution import SERIAL, Executor
from uvshear.io.bias_records import read_correction
from uvshear.io.shapes import extraction_record
from uvshear.pipeline.measurement import Measurement, read_measurement
from uvshear.pipeline.sample import sample_of, selected
from uvshear.progress import Meter, Progress
from uvshear.typing import Array

MeasurementLike: TypeAlias = Measurement | Table | str | Path
"""A measurement, a table of shapes, or the file that has it."""


def estimate_shear(
    measurement: MeasurementLike,
    estimator: EstimatorLike = "mean",
    *,
    snr_min: float = 0.0,
    flux_min: float = 0.0,
    where: Array | None = None,
    correction: BiasCorrection | str | Path | None = None,
    executor: Executor = SERIAL,
    progress: Progress | None = None,
) -> ShearEstimate:
    """Estimate the shear of the sources of a measurement, in total and by flux, in the frame of the sky.

    Parameters
    ----------
    measurement
        Measured sources with the statistics of the estimator.
    estimator
        Estimator, or its name. The default, the mean of ellipticities, is biased by noise.
    snr_min
        Measured signal-to-noise ratio below which sources are left out.
    flux_min
        Catalogue's flux below which sources are left out [Jy]: a cut on which shear and noise have no influence.
    where
        Sources to use: a boolean for each row of the shapes.
    correction
        Simulated bias that is taken out, or the file written by `uvshear bias` that has it.

    Raises
    ------
    InputError
        The statistics of the estimator were not kept, or fewer than two sources contribute to the shear.
    """
    method = estimator_of(estimator)
    bias = read_correction(correction) if isinstance(correction, str | Path) else correction
    if bias is not None and bias.estimator != method.name:
        raise InputError(
            f"the bias is that of the estimator '{bias.estimator}', not of '{method.name}'"
        )
    known = as_measurement(measurement)
    chosen = selected(known.shapes, snr_min=snr_min, flux_min=flux_min, where=where)
    sample = sample_of(known, method).select(chosen)
    found = estimate_sample_shear(method, sample, executor, Meter(progress))
    if bias is None:
        return found
    return replace(bias.applied(found), bins=bias.applied_by_flux(found.bins))


def as_measurement(given: MeasurementLike) -> Measurement:
    """Return a measurement, which may be given as an object, as a table of shapes, or as the path of a file."""
    if isinstance(given, Measurement):
        return given
    if isinstance(given, Table):
        return Measurement(given, None, None, extraction_record(given))
    if isinstance(given, str | Path):
        return read_measurement(given)
    raise InputError(
        f"{type(given).__name__}: a Measurement, a table of shapes, or the path of one is needed"
    )
