r"""Whether the visibilities agree with a catalogue under the sign of UVW as it is read, or under the opposite one.

A telescope may store X(ANTENNA2) - X(ANTENNA1) in UVW together with visibilities of the opposite phase (LOFAR, WSRT);
nothing is wrong with such a set. What matters is the phase of the data at the UVW that they have. With the opposite
sign the model of a sky is the complex conjugate, which differs in its imaginary part alone. The two signs are therefore
told apart by the factor

.. math:: a = \frac{\sum w\, \mathrm{Im}\,d\; \mathrm{Im}\,\mu}{\sum w\, (\mathrm{Im}\,\mu)^2}

that fits the imaginary parts of the data d by those of the model: it is near +1 if the sign is right and near -1 if it
is wrong. Sources at the phase centre, whose visibilities are real, do not tell.
"""

from typing import Final

import numpy as np

from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Complex, Float

CLEAR: Final = 8.0
"""Smallest number of standard errors at which the sign counts as wrong."""

FACTORS: Final = (0.3, 3.0)
"""Range of -a in which the sign counts as wrong. A bright source that is not in the catalogue may correlate with the
model through the sidelobes of the beam, but then a is not near -1."""


def opposite_sign_significance(samples: Samples, model: Complex[Array, " sample"]) -> float | None:
    """Return by how many standard errors the data prefer the opposite sign of UVW; None if they do not clearly do so.

    The error comes from the scatter of the products, so that neither wrong weights nor sources that are missing from
    the model make the sign look certain.

    Parameters
    ----------
    samples
        Visibilities.
    model
        Prediction of the catalogue for them [Jy].
    """
    imaginary = model.imag
    power = float(np.sum(samples.weights * imaginary**2, dtype=float))
    products: Float[Array, " sample"] = samples.weights * samples.stokes_i.imag * imaginary
    scatter = float(np.sqrt(np.sum(products.astype(float) ** 2)))
    if power == 0 or scatter == 0:
        return None
    total = float(np.sum(products, dtype=float))
    low, high = FACTORS
    if low <= -total / power <= high and total < -CLEAR * scatter:
        return -total / scatter
    return None
