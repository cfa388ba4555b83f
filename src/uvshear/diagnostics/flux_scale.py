r"""Whether the fluxes of a catalogue are of the size of those in the data.

The factor that fits the visibilities d by their prediction mu from the catalogue is

.. math:: a = \frac{\sum w\, \mathrm{Re}(d\, \mu^*)}{\sum w\, |\mu|^2}

and near 1 for a good catalogue. It is a power of ten if the catalogue has another unit than it claims.
"""

import math
from typing import Final

import numpy as np

from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Complex

OUT_OF_PROPORTION: Final = 100.0
"""Factor from which on the unit of the fluxes is in doubt. Sources that the catalogue lacks, and averaging that is not
modelled, change the factor by less."""

CLEAR: Final = 8.0
"""Smallest number of standard errors by which the factor must differ from any credible one."""


def flux_scale(samples: Samples, model: Complex[Array, " sample"]) -> float | None:
    """Return the fluxes in the data over those of the catalogue if they are out of proportion; None otherwise.

    Parameters
    ----------
    samples
        Visibilities.
    model
        Prediction of the catalogue for them [Jy].
    """
    prediction = model.astype(complex)
    power = float(np.sum(samples.weights * np.abs(prediction) ** 2, dtype=float))
    if not 0 < power < math.inf:
        return None
    products = samples.weights.astype(float) * (samples.stokes_i * prediction.conj()).real
    scale, error = float(products.sum()) / power, float(np.sqrt(np.sum(products**2))) / power
    if scale - CLEAR * error > OUT_OF_PROPORTION:
        return scale
    if 0 < abs(scale) + CLEAR * error < 1 / OUT_OF_PROPORTION:
        return max(abs(scale), error)
    return None
