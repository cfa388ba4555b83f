"""``uvshear reproduce``: the tables and figures of Rivi & Miller 2018, beside those of the paper."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from uvshear.cli.options import Overwrite, Seed, Threads, output_option, provenance
from uvshear.cli.outputs import reserve
from uvshear.cli.panels import METHOD, GroupedCommand
from uvshear.cli.progress_report import LogOption, begin_log, checked_log, progress_report
from uvshear.cli.terminal import say
from uvshear.errors import InputError
from uvshear.reproduce.names import PAPER, QUICK, SCALES, TARGETS

EPILOG = "Example: uvshear reproduce psf-images psf-zenith --scale quick -o reproduced"

SHORT = "Reproduce the tables and figures of Rivi & Miller (2018)."


class ScaleName(StrEnum):
    """Scale of a reproduction."""

    QUICK = QUICK
    PAPER = PAPER


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("reproduce", epilog=EPILOG, short_help=SHORT, cls=GroupedCommand)(reproduce)


def reproduce(
    context: typer.Context,
    output: Annotated[
        Path,
        output_option(
            "Directory for the page (index.md), the pictures, the numbers (JSON), and the parts of the computation,"
            " from which a run that was stopped goes on."
        ),
    ],
    targets: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[TARGET]...",
            help=f"What to reproduce; everything unless given: {', '.join(TARGETS)}.",
            show_default=False,
        ),
    ] = None,
    scale: Annotated[
        ScaleName,
        typer.Option(
            rich_help_panel=METHOD,
            help="; ".join(f"{name}: {what}" for name, what in SCALES.items()) + ".",
        ),
    ] = ScaleName.QUICK,
    seed: Seed = 1,
    threads: Threads = 0,
    log: LogOption = None,
    overwrite: Overwrite = False,
) -> None:
    """Reproduce tables and figures of Rivi & Miller (2018), and compare them with the paper on a page.

    With --overwrite the parts that an earlier run has left are computed anew. Without it, a run with the same options
    goes on from them.
    """
    for name in targets or ():
        if name not in TARGETS:
            raise InputError(
                f"TARGET {name}: is not known; the known targets are {', '.join(TARGETS)}"
            )

    from uvshear.execution import Resources, in_processes
    from uvshear.reproduce.run import reproduce_paper

    logs = checked_log(log, overwrite=overwrite)
    reserve(context, [output, *logs])
    logged = begin_log(context, log, [], overwrite=overwrite)
    with progress_report("reproducing the paper", logged) as progress:
        page = reproduce_paper(
            output,
            targets or (),
            scale=scale.value,
            seed=seed,
            resources=Resources(in_processes(threads)),
            progress=progress,
            provenance=provenance(context),
            overwrite=overwrite,
        )
    say(f"the page is {page}")
