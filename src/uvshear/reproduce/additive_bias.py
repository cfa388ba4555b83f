"""The base class of targets that measure the additive bias of isolated galaxies in several cases."""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

from uvshear.constants import MICROJANSKY
from uvshear.reproduce.finding import Estimate
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.repeats import TurnedPairs
from uvshear.reproduce.shape_sample import (
    ShapeTask,
    measure_shapes,
    sample_named,
    shape_tasks,
)
from uvshear.reproduce.shear_statistics import mean_bias
from uvshear.typing import Array

PAIRED = (
    "Each galaxy is measured with e and −e, with a realisation of the noise and its negative, and all four again with"
    " galaxy and noise rotated by 90 deg, which makes eight. In the mean, only those contributions to c remain that"
    " have a fixed direction, such as that of the PSF."
)


@dataclass(frozen=True)
class AdditiveBiasTarget(PaperTarget):
    """Additive bias of the mean ellipticity without a shear.

    Parameters
    ----------
    integration
        Length of a sample [s].
    galaxies
        Number of galaxies in each case, each of which is measured eight times.
    block
        Number of galaxies in a part.
    """

    integration: float = 900.0
    galaxies: int = 800
    block: int = 25

    @abstractmethod
    def cases(self) -> Mapping[str, MockSurvey]:
        """Return the surveys, by the names of their parts."""

    def tasks(self) -> Mapping[str, ShapeTask]:
        """Return blocks of galaxies for each case."""
        found: dict[str, ShapeTask] = {}
        for name, survey in self.cases().items():
            found |= shape_tasks(name, survey, self.galaxies_of(name), self.block, TurnedPairs())
        return found

    def galaxies_of(self, case: str) -> int:
        """Return the number of galaxies of a case, which is the same for all unless overridden."""
        del case
        return self.galaxies

    def measure(self, task: ShapeTask) -> Mapping[str, Array]:
        """Measure the shapes of a block of galaxies."""
        return measure_shapes(task)


def additive_bias(
    found: Mapping[str, Mapping[str, Array]], case: str, least_ujy: float = 0.0
) -> tuple[Estimate, Estimate]:
    """Return c1 and c2 of the galaxies of a case above a flux [uJy], in the frame of (l, m)."""
    sample = sample_named(found, case)
    bright = sample.select(sample.flux >= least_ujy * MICROJANSKY * (1 - 1e-9))
    return mean_bias(bright, (0j,)).c
