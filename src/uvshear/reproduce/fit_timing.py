"""Target ``timing``: time of a fit, and the use of several workers (section 4.2)."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from uvshear.execution import available_cores, in_processes
from uvshear.plot.curves import Curve, CurvePanel, draw_curves
from uvshear.reproduce.cell_counts import TableCount
from uvshear.reproduce.facet_ways import CellFacets, ExactFacetWay
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.mock_survey import MockSurvey
from uvshear.reproduce.paper_pointing import BASELINE, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.reproduce.shape_sample import ShapeTask, measure_shapes
from uvshear.typing import Array

WAYS = {"cells": CellFacets(TableCount()), "exact": ExactFacetWay()}
WORDS = {"cells": "facets of Table 1", "exact": "exact facets"}

BLOCK = 5
"""Number of galaxies in a task of a worker."""


@dataclass(frozen=True)
class FitTiming(PaperTarget):
    """Time of simulating a facet and measuring the shape of a galaxy, with one worker and with more.

    Parameters
    ----------
    pointing
        The observation.
    galaxies
        Number of galaxies for each number of workers.
    """

    name = "timing"
    title = "Time of a fit"
    is_alone: ClassVar[bool] = True

    pointing: PaperPointing = BASELINE
    galaxies: int = 1000

    def tasks(self) -> Mapping[str, tuple[str, int]]:
        """Return kinds of facets with numbers of workers."""
        workers = [1]
        while workers[-1] * 2 <= min(available_cores(), 8):
            workers.append(workers[-1] * 2)
        return {f"{way}-{number}": (way, number) for way in WAYS for number in workers}

    def measure(self, task: tuple[str, int]) -> Mapping[str, Array]:
        """Measure the wall time of the galaxies [s], after the facets of a few have been made."""
        way, workers = task
        survey = MockSurvey(WAYS[way], self.pointing, seed=self.seed)
        measure_shapes(ShapeTask(survey, 0, BLOCK))
        blocks = [ShapeTask(survey, first, BLOCK) for first in range(0, self.galaxies, BLOCK)]
        start = time.perf_counter()
        done = list(in_processes(workers).distribute(_measured, survey, blocks))
        return {"wall": np.array(time.perf_counter() - start), "number": np.array(sum(done))}

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare times per galaxy."""
        printed = PublishedFigures.read(self.name)
        seconds = {key: float(part["wall"]) / float(part["number"]) for key, part in found.items()}
        one, eight = (printed.estimate(name) for name in ("seconds_serial", "seconds_8_cores"))
        quantities = [
            Quantity(
                "time per galaxy, one core [s]",
                one,
                Estimate(seconds["cells-1"]),
                Estimate(seconds["exact-1"]),
            ),
            Quantity("time per galaxy, eight cores [s]", eight),
        ]
        curves = []
        for way in WAYS:
            numbers = [int(key.rpartition("-")[2]) for key in found if key.startswith(way)]
            speed = [seconds[f"{way}-1"] / seconds[f"{way}-{number}"] for number in numbers]
            curves.append(Curve(WORDS[way], [float(number) for number in numbers], speed))
            for number, faster in zip(numbers[1:], speed[1:], strict=True):
                estimate = Estimate(faster)
                quantities.append(
                    Quantity(
                        f"speed with {number} workers divided by that with one, {WORDS[way]}",
                        None,
                        estimate if way == "cells" else None,
                        estimate if way == "exact" else None,
                    )
                )
        published = Curve(
            "Rivi & Miller 2018",
            [1.0, 8.0],
            [1.0, one.value / eight.value],
            is_published=True,
            is_line=False,
        )
        panel = CurvePanel("workers", "speed divided by that of one worker", (published, *curves))
        caption = (
            "Speed of measuring shapes with several workers, divided by that with one: eight cores of an Intel Xeon"
            " E5-2650 in the paper, the cores of this machine here."
        )
        remarks = (
            f"The time is that of simulating a facet and measuring its shape, for {self.galaxies} galaxies of 10 to"
            " 200 µJy; the paper's is that of the fit alone. With the facets of Table 1 it is"
            f" {seconds['cells-1'] / one.value:.4f} of the paper's. Numbers depend on the machine and on what else"
            " runs on it.",
        )
        return Finding(tuple(quantities), draw_curves([panel]), caption, remarks)


def _measured(survey: MockSurvey, task: ShapeTask) -> int:
    del survey
    return len(measure_shapes(task)["galaxy"])
