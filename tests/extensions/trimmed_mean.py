"""An estimator of the shear of one's own: the mean without the most elliptical sources, with its response."""

from dataclasses import dataclass

import numpy as np

from uvshear import Estimator, Terms
from uvshear.geometry.ellipticity import add_shear

STEP = 0.01


@dataclass(frozen=True)
class TrimmedMean(Estimator):
    """Weighted mean of the ellipticities below a limit.

    A shear moves sources across the limit, which takes a part of the shear away. The response knows that: it comes from
    the ellipticities behind small shears, trimmed again. Sources near the limit count in part, which makes it smooth.
    """

    limit: float = 0.5
    width: float = 0.4

    name = "trimmed-mean"
    shape_columns = ("e1", "e2", "weight")

    def trimmed(self, e):
        """Return ellipticities, those above the limit as zeros."""
        return e * np.clip((self.limit - np.abs(e)) / self.width + 0.5, 0, 1)

    def terms(self, sample, about):
        """Return trimmed ellipticities and their derivatives by the shear, weighted."""
        e = sample["e1"] + 1j * sample["e2"]
        changes = [
            (self.trimmed(add_shear(e, g)) - self.trimmed(add_shear(e, -g))) / (2 * STEP)
            for g in (STEP, STEP * 1j)
        ]
        value, *response = (
            np.stack([x.real, x.imag], axis=-1) for x in (self.trimmed(e), *changes)
        )
        return Terms(value, np.stack(response, axis=-1)).weighted(sample["weight"])
