"""``uvshear average``: visibilities averaged over cells of (u, v, w), for a field of given width."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from pathlib import Path
from typing import Annotated

import typer

from uvshear.cli.clusters import SchedulerOption, executor_of
from uvshear.cli.options import Overwrite, Threads, output_option, positive
from uvshear.cli.outputs import reserve
from uvshear.cli.panels import METHOD, RESOURCES, GroupedCommand
from uvshear.cli.progress_report import LogOption, begin_log, checked_log, progress_report
from uvshear.cli.reading import (
    ColumnOption,
    ConjugateOption,
    FieldOption,
    ScansOption,
    SubtractOption,
    reading_of,
)
from uvshear.cli.terminal import say

EPILOG = "Example: uvshear average FIELD.ms --field-arcmin 30 -o COMPACT.ms"

SHORT = "Average visibilities over cells into a smaller Measurement Set."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("average", epilog=EPILOG, short_help=SHORT, cls=GroupedCommand)(average)


def average(
    context: typer.Context,
    measurement_sets: Annotated[
        list[Path],
        typer.Argument(
            metavar="FIELD.ms...",
            help="Visibilities of one pointing, in one or more Measurement Sets or MSv4 stores (zarr).",
        ),
    ],
    output: Annotated[Path, output_option("Measurement Set of the averages.")],
    field_arcmin: Annotated[
        float,
        typer.Option(
            callback=positive,
            rich_help_panel=METHOD,
            help="Width of the field in which sources will be measured: all of them should lie within half of it"
            " from the phase centre. A wider field needs smaller cells.",
            show_default=False,
        ),
    ],
    accuracy: Annotated[
        float,
        typer.Option(
            callback=positive,
            rich_help_panel=METHOD,
            help="Rms change of the shape of a source on the edge of the field, over its error. With 0.02 there are"
            " about twice as many rows as by default.",
        ),
    ] = 0.06,
    column: ColumnOption = "DATA",
    subtract: SubtractOption = None,
    field: FieldOption = None,
    scans: ScansOption = None,
    conjugate: ConjugateOption = False,
    log: LogOption = None,
    overwrite: Overwrite = False,
    threads: Threads = 0,
    scheduler: SchedulerOption = None,
    memory_gb: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=RESOURCES,
            help="Memory for the sums [GB]; by default half of the machine's memory. With less than 10.5 GB the last"
            " digits of the averages depend on it; where it is too small for all cells, the samples of some cells are"
            " averaged in several parts.",
        ),
    ] = None,
) -> None:
    """Average visibilities over cells of (u, v, w), and write a Measurement Set with one to four rows for each cell.

    Samples in a cell are averaged whatever their antennas, times, channels and sets. Only samples of different
    sub-bands (10 % wide) or of baselines with different pairs of dish diameters are kept apart. `measure` models the
    loss of amplitude in the cells. Other programs can image the set, but do not model this loss. UVW must not be
    recomputed, and antennas cannot be calibrated.
    """
    from uvshear.averaging.cells import Cells
    from uvshear.constants import ARCMIN
    from uvshear.execution import Resources, in_threads
    from uvshear.io.measurement_set.writer import check_measurement_set_output
    from uvshear.io.observations import open_observation
    from uvshear.pipeline.average import average as average_observation

    Cells.for_field(field_arcmin * ARCMIN, accuracy)
    check_measurement_set_output(output, overwrite=overwrite)
    outputs = [output, *checked_log(log, overwrite=overwrite)]
    reserve(context, outputs, measurement_sets)
    executor = executor_of(context, scheduler, in_threads(threads))
    resources = Resources(executor) if memory_gb is None else Resources(executor, memory_gb * 1e9)
    reading = reading_of(column, field, scans, conjugates=conjugate, subtracted=subtract)
    observation = open_observation(measurement_sets, reading)
    logged = begin_log(context, log, measurement_sets, overwrite=overwrite)
    with progress_report("averaging", logged) as progress:
        averaged = average_observation(
            observation,
            output,
            field_arcmin=field_arcmin,
            accuracy=accuracy,
            resources=resources,
            overwrite=overwrite,
            progress=progress,
        )
    say(
        f"{output}: {averaged.rows} rows from {averaged.samples} visibilities,"
        f" {averaged.samples / averaged.rows:.3g} in each"
    )
