"""The averages of an observation over cells of (u, v, w), in a Measurement Set that is measured like any other."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from uvshear.averaging.averager import Averager
from uvshear.averaging.cells import ACCURACY, Cells
from uvshear.averaging.dish_pairs import DishPairs
from uvshear.averaging.in_partitions import add_in_partitions, samples_to_average
from uvshear.constants import ARCMIN
from uvshear.errors import InputError
from uvshear.execution import Resources
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.counted import counted
from uvshear.interferometer.dishes import HasDishes, dish_diameters, pointing_of
from uvshear.interferometer.expected_samples import expected_samples
from uvshear.interferometer.origin import origin_of, parts_of
from uvshear.interferometer.partitions import HasRows
from uvshear.interferometer.visibilities import Observation
from uvshear.io.measurement_set.averages_writer import AveragedField, new_averages
from uvshear.pipeline.observation import ObservationLike, observation_of
from uvshear.progress import Meter, Progress, Stage
from uvshear.typing import Array, Float

SAMPLE, CELL = 110.0, 1500.0
"""Time in which a sample is averaged on one core, and in which the rows of a cell are written [ns]."""

GAIN = 0.7
"""Logarithm of the gain in speed by some workers, over that of their number."""

NEW_CELLS = 0.6
"""Logarithm of the growth of the number of cells, over that of the samples."""


@dataclass(frozen=True)
class Averaged:
    """Numbers of samples with weight, and of the rows that they have become."""

    samples: int
    rows: int


def average(
    visibilities: ObservationLike,
    output: str | Path,
    *,
    field_arcmin: float,
    accuracy: float = ACCURACY,
    resources: Resources | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Averaged:
    """Average an observation over cells of (u, v, w), and write the averages as a Measurement Set.

    Parameters
    ----------
    visibilities
        An observation, or the path or paths of its files.
    output
        Path of the Measurement Set.
    field_arcmin
        Width of the field in which sources will be measured [arcmin].
    accuracy
        Rms change of the shape of a source at the edge of the field, over its error.
    resources
        Workers, and memory for the sums.
    overwrite
        Whether a Measurement Set that exists is replaced.
    progress
        Function called with the number of visibilities read so far and their total, or an observer of the stages.

    Returns
    -------
    Averaged
        Numbers of samples and rows.
    """
    cells = Cells.for_field(field_arcmin * ARCMIN, accuracy)
    resources = resources or Resources()
    observation = observation_of(visibilities)
    parts = parts_of(observation)
    pairs = DishPairs.from_diameters([_diameters(part) for part in parts])
    meter, total = Meter(progress), expected_samples(observation)
    cost = total * SAMPLE / resources.executor.workers**GAIN
    meter.begin(Stage("averaging", cost, total, "visibilities"), Stage("writing"))
    about = AveragedField(observation.phase_centre, _pointing(observation), pairs[0], cells)
    with new_averages(Path(output), about, overwrite=overwrite) as writer:
        averager = Averager(cells, writer.add, resources)
        seen = 0.0

        def on_samples(count: float) -> None:
            nonlocal seen
            seen += count
            meter.add(count)
            # Rows of later integrations lie partly in the cells of earlier ones.
            expected = averager.cells * max(1.0, total / seen) ** NEW_CELLS
            meter.foresee(Stage("writing", expected * CELL))

        in_files = [part for part in parts if isinstance(part, HasRows)]
        if len(in_files) == len(parts):
            files = list(zip(in_files, pairs, strict=True))
            add_in_partitions(averager, files, cells, resources, on_samples)
        else:
            for part, dishes in zip(parts, pairs, strict=True):
                averager.add(counted(samples_to_average(part), on_samples), dishes)
        meter.begin(Stage("writing", averager.cells * CELL, averager.cells, "cells"))
        samples = averager.finish(meter.add)
        if not samples:
            raise InputError("no visibility carries weight; there is nothing to average")
        names = ", ".join(origin_of(part).name for part in parts)
        meter.finish()
        writer.finish(f"averages over cells of {cells.uv:.4g} x {cells.w:.4g} wavelengths: {names}")
    return Averaged(samples, writer.rows)


def _diameters(part: Observation) -> Float[Array, " antenna"]:
    """Return the diameters of the dishes [m]; they are taken to be alike where they are not known."""
    known = isinstance(origin_of(part).observation, HasDishes)
    diameters = dish_diameters(part) if known else np.zeros(0)
    return diameters if len(diameters) else np.zeros(1)


def _pointing(observation: Observation) -> PhaseCentre:
    seen = origin_of(parts_of(observation)[0]).observation
    if not isinstance(seen, HasDishes):
        return observation.phase_centre
    pointing_of(observation)
    return seen.pointing_direction()
