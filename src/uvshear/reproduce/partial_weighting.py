"""Weights between the natural ones and those of a weighting."""

from dataclasses import dataclass

import numpy as np

from uvshear.interferometer.baseline_map import Factors
from uvshear.interferometer.visibilities import Visibilities
from uvshear.interferometer.weighting import WeightedObservation, Weighting
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class PartialWeighting(Weighting):
    """Factors 1 + part (T - 1), with the factors T of another weighting.

    With T = 1 + d, where d is small, the PSF depends on w (1 + part d), and the variance of the noise to first order on
    w (1 + 2 part d). Half of a weighting thus does to the noise what the whole does to the PSF.

    Parameters
    ----------
    whole
        The other weighting.
    part
        0 for natural weights, 1 for those of the other weighting.
    """

    whole: Weighting
    part: float

    def factors_for(self, observation: WeightedObservation) -> Factors:
        """Read the observation for the other weighting."""
        whole = self.whole.factors_for(observation)

        def factors(seen: Visibilities) -> Float[Array, "row chan"]:
            mixed: Float[Array, "row chan"] = 1 + self.part * (np.asarray(whole(seen)) - 1)
            return mixed

        return factors
