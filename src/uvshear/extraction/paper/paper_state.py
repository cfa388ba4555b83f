"""The state of the paper's extraction between two batches of sources."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self

from uvshear.extraction.paper.paper_sky import PaperSky
from uvshear.shapes.measurement import ShapeMeasurement


@dataclass(frozen=True)
class PaperState:
    """How far the extraction has come.

    Parameters
    ----------
    sky
        The sky with the fits so far.
    batches
        Number of batches that have been fitted, in all passes.
    measurements
        Shapes that were measured in the last pass, by index of the catalogue.
    measured_again
        Shapes of the sources whose first measurement was bad.
    """

    sky: PaperSky
    batches: int = 0
    measurements: Mapping[int, ShapeMeasurement] = field(default_factory=dict)
    measured_again: Mapping[int, ShapeMeasurement] = field(default_factory=dict)

    def with_sky(self, sky: PaperSky) -> Self:
        """Return the state after another batch."""
        return replace(self, sky=sky, batches=self.batches + 1)
