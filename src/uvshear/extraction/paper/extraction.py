"""Rivi & Miller 2018, section 2.2: one source after the other, in decreasing flux.

1. The first sky model consists of round galaxies with the catalogue's fluxes and median sizes.
2. Beginning with the brightest source: subtract all others, make its facet, fit it, and replace the round galaxy by the
   fitted one.
3. A source with a bad measurement stays round. When all others are done it is fitted again, from scratch, with the
   better sky; if the measurement is bad again, it keeps its flag and has no weight.
"""

from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.extraction.extraction import Extracted, Extraction, Setting
from uvshear.extraction.field import Field
from uvshear.extraction.paper.cell_average import CellAverageFacets, PaperTable
from uvshear.extraction.paper.facets import FacetMethod
from uvshear.extraction.paper.paper_sky import PaperSky
from uvshear.extraction.paper.paper_state import PaperState
from uvshear.extraction.paper.sequential_pass import SequentialPass, batches
from uvshear.interferometer.visibilities import Observation
from uvshear.progress import Meter, Progress, Stage
from uvshear.shapes.measurement import FitFlag

BAD: Final = frozenset(
    {FitFlag.NO_PEAK, FitFlag.OFF_POSITION, FitFlag.NOT_CONVERGED, FitFlag.UNRELIABLE}
)
"""Flags of sources that are fitted again with a better sky; it does not help a source that the baselines do not
determine."""

_SKY: Final = "sky"


@dataclass(frozen=True)
class PaperExtraction(Extraction):
    """Extraction that fits sources in order of decreasing flux, in parallel where they are far apart.

    Parameters
    ----------
    facet
        Method of making facets; the paper's unless given.
    passes
        Number of passes over the sources; the paper makes one. Those before the last improve the sky.
    separation
        Sources closer than this are fitted one after the other, the brighter first [rad].
    """

    facet: FacetMethod = field(default_factory=lambda: CellAverageFacets(PaperTable()))
    passes: int = 1
    separation: float = 60 * ARCSEC

    def __post_init__(self) -> None:
        if self.passes < 1:
            raise InputError(f"{self.passes} passes over the sources; one or more are needed")

    def extract(
        self,
        observation: Observation,
        field: Field,
        setting: Setting,
        progress: Progress | None = None,
    ) -> Extracted:
        """Measure every source, and those with a bad measurement once more at the end."""
        if setting.model.primary_beam is not None:
            raise InputError("PaperExtraction cannot model a primary beam; use ConvergedExtraction")
        meter, store = Meter(progress), setting.store
        run = SequentialPass(observation, field, setting, self.facet, meter.add)
        order = batches(field, field.measured, self.separation)
        reached: PaperState = store.load(_SKY) or PaperState(PaperSky(field.sky))
        first = self.passes * len(order)
        rows = (first - min(reached.batches, first)) * field.summary.rows
        meter.begin(Stage("sources", rows, rows, "rows"))
        while reached.batches < first:
            fit = run.improve if reached.batches < first - len(order) else run.measure
            reached = fit(reached, order[reached.batches % len(order)])
            if store.is_due:
                store.save(_SKY, reached)
        bad = [source for source, shape in reached.measurements.items() if shape.flag in BAD]
        if bad and reached.batches == first:
            reached = replace(reached, sky=reached.sky.without_starts(bad))
        again = batches(field, np.array(bad), self.separation) if bad else []
        meter.expect((first + len(again) - reached.batches) * field.summary.rows)
        while reached.batches < first + len(again):
            reached = run.measure_again(reached, again[reached.batches - first])
            if store.is_due:
                store.save(_SKY, reached)
        meter.finish()
        sky, measurements = reached.sky, {**reached.measurements, **reached.measured_again}
        return Extracted(
            measurements=measurements,
            sky=sky.sky,
            uv_range=field.uv_range,
            record={
                "extraction": "paper",
                "facet": type(self.facet).__name__,
                "averages_cells": self.facet.averages_cells,
                "passes": self.passes,
                "major_cycles": sky.major_cycles,
                "fitted_again": len(bad),
                "bad_again": sum(measurements[source].flag in BAD for source in bad),
            },
        )
