"""The numbers of one measurement in the columns of the table of shapes."""

import math
from collections.abc import Mapping

import numpy as np

from uvshear.galaxy import EllipticityPrior
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.weight import lensfit_weight


def shape_values(shape: ShapeMeasurement, population: EllipticityPrior) -> Mapping[str, float]:
    """Values by column of the table of shapes, in SI and radians; the weight is 0 unless the flag is OK.

    Parameters
    ----------
    population
        Distribution of intrinsic ellipticities, for the weight.
    """
    is_ok = shape.flag is FitFlag.OK
    weight = float(lensfit_weight(np.array([shape.e_sigma]), population)[0]) if is_ok else 0.0
    return {
        "e1": float(shape.ellipticity[0]),
        "e2": float(shape.ellipticity[1]),
        "e1_err": math.sqrt(shape.covariance[0, 0]),
        "e2_err": math.sqrt(shape.covariance[1, 1]),
        "e12_cov": float(shape.covariance[0, 1]),
        "e_sigma": float(shape.e_sigma),
        "weight": weight,
        "snr": shape.snr,
        "scale_length": shape.scale_length,
        "scale_length_err": shape.scale_length_err,
        "flux_fit": shape.flux,
        "flux_fit_err": shape.flux_err,
        "dl": float(shape.offset[0]),
        "dm": float(shape.offset[1]),
        "detection": shape.quality.detection,
        "resolved": shape.quality.resolved,
        "error_widening": shape.quality.error_widening,
        "remaining_change": shape.quality.remaining_change,
    }
