r"""Visibilities whose residual cannot be noise.

For noise, the powers in units of the variance, :math:`x = w |r|^2 / 2`, are exponentially distributed with a mean s^2.
It is estimated from their median, which a few outliers hardly change. The largest of N exceeds
:math:`s^2 (\ln N + t)` with a probability of :math:`e^{-t}`.
"""

import math
from typing import Final

import numpy as np

from uvshear.interferometer.noise_estimate import Predict
from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Float

RARE: Final = 20.0
"""The t of the limit: one observation in 5e8 has an outlier by chance."""

FEW: Final = 0.01
"""Largest fraction of the visibilities that are reported as outliers. If more are beyond the limit, sky is missing in
the model, which the comparison of the noise with the weights reports."""

FEWEST: Final = 100
"""Number of visibilities below which nothing is checked."""

EQUAL: Final = 0.01
"""Ratio of the effective to the actual number of visibilities below which the weights are too unequal to be right; in
arrays with dishes of all sizes it is a few per cent or more."""


def outlier_warning(name: str, samples: Samples, predict: Predict) -> str | None:
    """Return a line about visibilities that are too far from the predicted sky; None if there are none.

    Parameters
    ----------
    name
        Name of the set, for the message.
    samples
        Visibilities, all of which have weight.
    predict
        Function that predicts the sky.
    """
    number = len(samples)
    if number < FEWEST:
        return None
    residual = samples.stokes_i.astype(complex) - predict(samples)
    power = np.abs(residual) ** 2 * samples.weights.astype(float) / 2
    # Without noise, as in some simulations, the residual only shows the accuracy of the model.
    variance = max(float(np.median(power)) / math.log(2), 1.0)
    limit = math.log(number) + RARE
    beyond = int(np.count_nonzero(power > limit * variance))
    if not 0 < beyond <= FEW * number:
        return None
    return (
        f"{name}: {beyond} of {number} visibilities that were looked at are more than {math.sqrt(2 * limit):.1f} times"
        " the noise away from the fitted sky; interference that is not flagged, wrong weights, or emission that the"
        " catalogue lacks can disturb the shapes"
    )


def weight_warning(name: str, weights: Float[Array, " sample"]) -> str | None:
    r"""Return a line if a few weights count for more than all others; None otherwise.

    .. math:: N_\mathrm{eff} = \left(\sum w\right)^2 / \sum w^2
    """
    number = len(weights)
    if number < FEWEST:
        return None
    scaled = weights.astype(float) / float(weights.max())
    effective = float(scaled.sum() ** 2 / np.sum(scaled**2))
    if effective >= EQUAL * number:
        return None
    return (
        f"{name}: the weights are so unequal that {number} visibilities count for no more than {effective:.2g} with"
        " equal weights; errors and shapes depend on these few"
    )
