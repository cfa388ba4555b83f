"""The sample of sources from which an estimator of the shear works."""

import numpy as np
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.estimators import Estimator, Sample
from uvshear.geometry.directions import local_north
from uvshear.io.shape_checks import as_words
from uvshear.io.shapes import COLUMNS, inside, phase_centre_of
from uvshear.pipeline.measurement import Measurement
from uvshear.shapes.measurement import FitFlag
from uvshear.shapes.statistic_flag import StatisticFlag, flag_column
from uvshear.typing import Array, Bool

FITTED = tuple(flag.word for flag in FitFlag if flag.is_fitted)
"""Flags of sources whose fit succeeded, whether or not what it found is significant."""


def sample_of(measurement: Measurement, estimator: Estimator) -> Sample:
    """Return all sources of a measurement, with the columns that the estimator needs.

    Raises
    ------
    InputError
        The statistics of the estimator were not kept.
    """
    shapes = measurement.shapes
    names = [*estimator.shape_columns]
    if "flux" in shapes.colnames:
        names.append("flux")
    columns = {name: inside(shapes, name) for name in names}
    columns |= {name: _kept(measurement, estimator, name) for name in estimator.columns}
    north = local_north(phase_centre_of(shapes), inside(shapes, "l"), inside(shapes, "m"))
    sample = Sample(columns, north)
    if estimator.columns:
        _refuse_damage(measurement, estimator, sample)
    return sample


def _refuse_damage(measurement: Measurement, estimator: Estimator, sample: Sample) -> None:
    """Refuse statistics of which some sources have numbers that were not kept so."""
    table, name = measurement.statistics, flag_column(estimator.name)
    found = estimator.damaged(sample)
    if table is not None and name in table.colnames:
        # The first of the numbers tells whether there are any.
        first = sample[next(iter(estimator.columns))]
        empty = np.array([np.size(value) == 0 or not np.isfinite(value).all() for value in first])
        found |= empty & (as_words(table[name]) == StatisticFlag.OK.word)
    if found.any():
        row = int(np.argmax(found))
        raise InputError(
            f"the statistics of the estimator '{estimator.name}' are damaged in row {row + 1}: their numbers cannot"
            " belong together; measure again"
        )


def selected(
    shapes: Table,
    *,
    snr_min: float = 0.0,
    detection_min: float = 0.0,
    flux_min: float = 0.0,
    where: Array | None = None,
) -> Bool[Array, " source"]:
    """Choose sources that were measured, above limits of measured significances and of the catalogue's flux [Jy].

    Shear and noise move galaxies across a cut by ``snr`` or ``detection``, which biases any shear; a lens without
    magnification does not change the flux. Sources that are flagged for a low significance are therefore chosen: they
    have a weight of zero in the mean of ellipticities, and their statistics tell other estimators how little is known.

    Parameters
    ----------
    snr_min, detection_min
        Least values of the columns ``snr`` and ``detection``.
    flux_min
        Least flux in the catalogue [Jy].
    where
        Condition of the user's own: a boolean for each row.
    """
    chosen = np.isin(np.asarray(shapes["flag"]).astype(str), FITTED)
    chosen &= inside(shapes, "snr") >= snr_min
    if detection_min > 0:
        chosen &= inside(shapes, "detection") >= detection_min
    if flux_min > 0:
        chosen &= inside(shapes, "flux") >= flux_min
    if where is not None:
        mask = np.asarray(where)
        if mask.dtype != bool or mask.shape != chosen.shape:
            raise InputError(
                f"where: {len(shapes)} booleans are needed, one for each row of the shapes,"
                f" not {mask.dtype} of shape {mask.shape}"
            )
        chosen &= mask
    return chosen


def _kept(measurement: Measurement, estimator: Estimator, name: str) -> Array:
    table = measurement.statistics
    if table is None or name not in table.colnames:
        raise InputError(
            f"the statistics of the estimator '{estimator.name}' were not kept with the shapes;"
            f' measure again with --keep {estimator.name} (keep="{estimator.name}")'
        )
    column = table[name]
    if len(column) and column.dtype.kind == "O":
        return np.asarray(column)
    if column.dtype.kind not in "fiu":
        raise InputError(
            f"the statistics of the estimator '{estimator.name}': column '{name}' holds no numbers; measure again"
        )
    filled: Array = np.ma.filled(np.ma.asarray(column, dtype=float), np.nan)
    return filled * COLUMNS[name].inside if name in COLUMNS else filled
