"""Estimation of a shear from a measurement."""

import warnings
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from astropy.table import Table

from uvshear.errors import DataWarning, InputError
from uvshear.estimators import Bias, ShearEstimate, estimate_sample_shear, estimator_of
from uvshear.estimators.bias_removal import check_removable, remove_bias
from uvshear.estimators.patches import sky_patches
from uvshear.estimators.registry import EstimatorLike
from uvshear.estimators.shear_estimate import ShearConditions
from uvshear.execution import SERIAL, Executor
from uvshear.io.bias_records import read_bias
from uvshear.io.shape_checks import check_shapes
from uvshear.io.shapes import averages_cells, extraction_record, inside
from uvshear.pipeline.measurement import Measurement, read_measurement
from uvshear.pipeline.sample import sample_of, selected
from uvshear.progress import Meter, Progress
from uvshear.typing import Array

MeasurementLike: TypeAlias = Measurement | Table | str | Path
"""A measurement, a table of shapes, or the file that has it."""


def estimate_shear(  # noqa: PLR0913 - the cuts are arguments of their own
    measurement: MeasurementLike,
    estimator: EstimatorLike = "mean",
    *,
    snr_min: float = 0.0,
    detection_min: float = 0.0,
    flux_min: float = 0.0,
    where: Array | None = None,
    patches: int | None = None,
    correction: Bias | str | Path | None = None,
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
    detection_min
        Significance (column ``detection``) below which sources are left out.
    flux_min
        Catalogue's flux below which sources are left out [Jy]: a cut on which shear and noise have no influence.
    where
        Sources to use: a boolean for each row of the shapes.
    patches
        Number of patches of the sky that the jackknife leaves out in turn for the standard errors; it leaves out single
        sources unless given.
    correction
        Simulated bias that is removed, or its file. It must come from the same estimator and the same cuts.

    Raises
    ------
    InputError
        The statistics of the estimator were not kept, fewer than two sources contribute to the shear, or the bias does
        not belong to this shear.

    Warns
    -----
    DataWarning
        The cut ``snr_min`` of the bias was one on the catalogue's flux, whereas that of the shear is one on the fit;
        the population that the estimator assumes does not fit the galaxies; or the galaxies do not determine the shear.
    """
    method = estimator_of(estimator)
    bias, name = _bias_of(correction)
    known = as_measurement(measurement)
    conditions = ShearConditions(
        method.name, method.record(), snr_min, flux_min, averages_cells(known.shapes), detection_min
    )
    if bias is not None and detection_min > 0:
        raise InputError(
            f"--detection-min {detection_min:g} (detection_min=): simulated biases do not have this cut; leave it out,"
            " or do not remove a bias"
        )
    if bias is not None:
        check_removable(bias, conditions, name)
    chosen = selected(
        known.shapes, snr_min=snr_min, detection_min=detection_min, flux_min=flux_min, where=where
    )
    sample = sample_of(known, method).select(chosen)
    if patches is not None:
        l, m = (inside(known.shapes, name)[chosen] for name in ("l", "m"))
        sample = replace(sample, patch=sky_patches(l, m, patches))
    found = estimate_sample_shear(method, sample, executor, Meter(progress))
    for remark in found.remarks:
        warnings.warn(remark, DataWarning, stacklevel=2)
    found = replace(found, seed=getattr(method, "seed", None), conditions=conditions)
    return found if bias is None else replace(remove_bias(bias, found), correction=name)


def _bias_of(correction: Bias | str | Path | None) -> tuple[Bias | None, str]:
    """Return a bias and its name in messages."""
    if correction is None or isinstance(correction, Bias):
        return correction, "the bias"
    if isinstance(correction, str | Path):
        return read_bias(correction), str(correction)
    raise InputError(
        f"correction={correction!r}: a Bias or the path of its file is needed, not the type {type(correction).__name__}"
    )


def as_measurement(given: MeasurementLike) -> Measurement:
    """Return a measurement, which may be given as an object, as a table of shapes, or as the path of a file."""
    if isinstance(given, Measurement):
        return given
    if isinstance(given, Table):
        check_shapes(given, "the table of shapes")
        return Measurement(given, None, None, extraction_record(given))
    if isinstance(given, str | Path):
        return read_measurement(given)
    raise InputError(
        f"{type(given).__name__}: a Measurement, a table of shapes, or the path of one is needed"
    )
