"""A direct sum over galaxies that has been planned."""

from dataclasses import dataclass

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Galaxies, Profile
from uvshear.predict.direct import predict_visibilities
from uvshear.predict.drawable import SUM
from uvshear.predict.losses import Losses
from uvshear.predict.prediction import Prediction
from uvshear.progress import Progress
from uvshear.typing import Array, Complex, Float

WITH_LOSSES = 3.0
"""Time of a sum with losses by averaging over that of one without. Primary beams take more or less."""


@dataclass(frozen=True)
class DirectSum(Prediction):
    """Visibilities of galaxies that are summed (``predict_visibilities``, whose arguments these are)."""

    galaxies: Galaxies
    uvw: Float[Array, "row 3"]
    frequency: Float[Array, " chan"]
    profile: Profile
    losses: Losses | None
    dtype: type[np.floating]

    @property
    def cost(self) -> float:
        """Estimated time on one core [ns]."""
        of_losses = 1.0 if self.losses is None else WITH_LOSSES
        return of_losses * SUM * len(self.uvw) * len(self.frequency) * len(self.galaxies)

    def visibilities(
        self, executor: Executor = SERIAL, progress: Progress | None = None
    ) -> Complex[Array, "row chan"]:
        """Sum the visibilities [Jy]."""
        return predict_visibilities(
            self.galaxies,
            self.uvw,
            self.frequency,
            self.profile,
            executor,
            self.losses,
            self.dtype,
            progress,
        )
