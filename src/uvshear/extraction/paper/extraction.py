"""Rivi & Miller 2018, section 2.2: one source after the other, in decreasing flux.

1. The sky begins as circles of the catalogue's fluxes and of median size.
2. The brightest source: subtract all others, cut out its facet, fit it, and let the fitted ellipse replace the
   circle. Then the next.
3. A bad measurement leaves its circle where it was. When all others are done it is fitted again, from nothing,
   against the better sky; if it is bad again, it keeps its flag, and with it no weight.
"""

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.extraction.extraction import Extracted, Extraction, Setting
from uvshear.extraction.field import Field
from uvshear.extraction.paper.cell_average import CellAverageFacets, PaperTable
from uvshear.extraction.paper.facets import FacetMethod
from uvshear.extraction.paper.sequential_pass import Sweep
from uvshear.interferometer.visibilities import Observation
from uvshear.progress import Progress
from uvshear.shapes.measurement import FitFlag

BAD: Final = frozenset(
    {FitFlag.NO_PEAK, FitFlag.OFF_POSITION, FitFlag.NOT_CONVERGED, FitFlag.UNRELIABLE}
)
"""Flags that a better sky may take away; what the baselines do not tell stays untold."""


@dataclass(frozen=True)
class PaperExtraction(Extraction):
    """Sources in decreasing flux, side by side where they are far apart.

    Parameters
    ----------
    facet
        Way of making facets; the paper's unless given.
    rounds
        Passes over the sources; the paper makes one. Those before the last improve the sky.
    separation
        Sources closer than this are fitted one after the other, the brighter first [rad].
    """

    facet: FacetMethod = field(default_factory=lambda: CellAverageFacets(PaperTable()))
    rounds: int = 1
    separation: float = 60 * ARCSEC

    def __post_init__(self) -> None:
        if self.rounds < 1:
            raise InputError(f"{self.rounds} rounds; one or more are needed")

    def extract(
        self,
        observation: Observation,
        field: Field,
        setting: Setting,
        progress: Progress | None = None,
    ) -> Extracted:
        """Measure every source, and the bad ones once more at the end."""
        if setting.model.primary_beam is not None:
            raise InputError("the paper's extraction has no primary beam; ConvergedExtraction has")
        sweep = Sweep(observation, field, setting, facet=self.facet, progress=progress)
        everything = sweep.batches(field.measured, self.separation)
        sweep.expect(self.rounds * len(everything))
        for _ in range(self.rounds - 1):
            sweep.improve_sky(everything)
        measurements = sweep.measure_shapes(everything)
        bad = [source for source, shape in measurements.items() if shape.flag in BAD]
        if bad:
            put_aside = sweep.batches(np.array(bad), self.separation)
            sweep.expect(len(put_aside))
            sweep.forget(bad)
            measurements |= sweep.measure_shapes(put_aside)
        return Extracted(
            measurements=measurements,
            sky=sweep.sky,
            uv_range=field.uv_range,
            record={
                "extraction": "paper",
                "facet": type(self.facet).__name__,
                "averages_cells": self.facet.averages_cells,
                "rounds": self.rounds,
                "visits": sweep.visits,
                "fitted_again": len(bad),
                "bad_again": sum(measurements[source].flag in BAD for source in bad),
            },
        )
