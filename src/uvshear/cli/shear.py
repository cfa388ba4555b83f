"""``uvshear shear``: the shear of measured galaxies."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.estimators import NAMES, PAPER, PRIOR_METAVAR, estimator_named
from uvshear.cli.options import Overwrite, Threads, non_negative, provenance
from uvshear.cli.outputs import reserve
from uvshear.cli.panels import DATA, METHOD, OUTPUT, GroupedCommand
from uvshear.cli.progress_report import progress_report
from uvshear.cli.terminal import notes_of_warnings, remarks, say, show, warn

if TYPE_CHECKING:
    from collections.abc import Mapping

EPILOG = "Example: uvshear shear SHAPES.fits --estimator moments -o SHEAR.json"

SHORT = "Estimate the shear of measured galaxies."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("shear", epilog=EPILOG, short_help=SHORT, cls=GroupedCommand)(shear)


def shear(
    context: typer.Context,
    shapes: Annotated[Path, typer.Argument(help="Table written by uvshear measure.")],
    estimator: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            rich_help_panel=METHOD,
            help=f"Estimator of the shear: {NAMES}, or MODULE:NAME of your own. The mean is biased by noise;"
            " moments and bayesian are not. All but the mean need the statistics that measure --keep stores.",
        ),
    ] = "mean",
    snr_min: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            rich_help_panel=DATA,
            help="Measured signal-to-noise ratio (column snr) below which galaxies are left out. Shear and noise move"
            " galaxies across this cut, which biases the shear.",
        ),
    ] = 0.0,
    detection_min: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            rich_help_panel=DATA,
            help="Measured significance of a galaxy (column detection) below which galaxies are left out. This cut"
            " biases the shear, too.",
        ),
    ] = 0.0,
    flux_min_ujy: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            rich_help_panel=DATA,
            help="Catalogue flux below which galaxies are left out; shear does not move galaxies across this cut.",
        ),
    ] = 0.0,
    calibration: Annotated[
        Path | None,
        typer.Option(
            rich_help_panel=METHOD,
            help="File written by uvshear bias. The bias in it is removed from the shear.",
        ),
    ] = None,
    prior: Annotated[
        str,
        typer.Option(
            metavar=PRIOR_METAVAR,
            rich_help_panel=METHOD,
            help="Population of galaxies that bayesian assumes: paper (that of Rivi & Miller 2018), fitted (fitted"
            " to these sources), or a JSON file.",
        ),
    ] = PAPER,
    patches: Annotated[
        int | None,
        typer.Option(
            min=2,
            rich_help_panel=METHOD,
            help="Number of patches of the sky for the jackknife, which leaves out one at a time; the standard"
            " errors then include correlations between neighbouring galaxies. By default it leaves out single"
            " galaxies.",
        ),
    ] = None,
    seed: Annotated[
        int,
        typer.Option(
            min=0,
            help="Seed for an estimator of your own that draws random numbers; the estimators of the package use"
            " none here.",
        ),
    ] = 1,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", rich_help_panel=OUTPUT, help="JSON file to write."),
    ] = None,
    overwrite: Overwrite = False,
    threads: Threads = 1,
) -> None:
    """Estimate the shear of measured galaxies, in the frame of local North, in total and by flux."""
    from uvshear.constants import MICROJANSKY
    from uvshear.execution import in_processes
    from uvshear.io.outputs import check_file
    from uvshear.io.shear_records import write_shear
    from uvshear.pipeline.measurement import companions
    from uvshear.pipeline.shear import estimate_shear

    if output is not None:
        check_file(output, overwrite=overwrite)
        others = [Path(prior), *([] if calibration is None else [calibration])]
        reserve(context, [output], [shapes, *companions(shapes), *others])
    method = estimator_named(estimator, prior=prior, seed=seed)
    with notes_of_warnings(), progress_report("estimating the shear") as progress:
        found = estimate_shear(
            shapes,
            method,
            snr_min=snr_min,
            detection_min=detection_min,
            flux_min=flux_min_ujy * MICROJANSKY,
            patches=patches,
            correction=calibration,
            executor=in_processes(threads),
            progress=progress,
        )
    if output is not None:
        made = provenance(context, shapes, *(() if calibration is None else (calibration,)))
        write_shear(output, found, made, overwrite=overwrite)
    with remarks():
        population = found.assumed.get("population")
        if isinstance(population, dict) and (text := describe_population(population)):
            say(text)
    tell = show if output is None else say
    tell("\n".join([str(found), *(f"{name}: {part}" for name, part in found.bins.items())]))
    with remarks():
        if method.remark and calibration is None:
            warn(method.remark)


def describe_population(record: "Mapping[str, Mapping[str, float]]") -> str:
    """Return a line with the fitted parameters of a population; empty if none was fitted."""
    parts = [
        f"{part} {name} = {value:.3f} +- {values[f'{name}_err']:.3f}"
        for part, values in record.items()
        for name, value in values.items()
        if f"{name}_err" in values
    ]
    return f"fitted population: {', '.join(parts)}" if parts else ""
