"""``uvshear bias``: the bias of an estimator of the shear, on simulated galaxies."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import math
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from uvshear.cli.clusters import SchedulerOption, executor_of
from uvshear.cli.estimators import NAMES, PAPER, PRIOR_METAVAR, estimator_named
from uvshear.cli.extractions import FacetName
from uvshear.cli.options import (
    Overwrite,
    Pair,
    Seed,
    Threads,
    declination,
    non_negative,
    positive,
    positive_pair,
    positive_range,
    provenance,
)
from uvshear.cli.outputs import reserve
from uvshear.cli.panels import ARRAY, METHOD, NOISE, OUTPUT, SKY, GroupedCommand
from uvshear.cli.progress_report import LogOption, begin_log, checked_log, progress_report
from uvshear.cli.registered import PROFILES, profile_named_by_option
from uvshear.cli.terminal import remarks, say
from uvshear.errors import InputError

EPILOG = (
    "Example: uvshear bias --estimator moments --galaxies 20000 --snr-min 10 --shear 0.03 --seed 1 "
    "-o BIAS.json"
)

MEAN = "mean"


class SelectionName(StrEnum):
    """Signal-to-noise ratio to which a cut applies."""

    CATALOGUE = "catalogue"
    MEASURED = "measured"


SHORT = "Measure the bias m and c of an estimator on simulated galaxies."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("bias", epilog=EPILOG, short_help=SHORT, cls=GroupedCommand)(bias)


def bias(
    context: typer.Context,
    estimator: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            rich_help_panel=METHOD,
            help=f"Estimator of the shear: {NAMES}, or MODULE:NAME of your own.",
            show_default=False,
        ),
    ],
    galaxies: Annotated[
        int,
        typer.Option(
            min=100,
            rich_help_panel=SKY,
            help="Number of galaxies. For each shear an isolated galaxy is measured four times: with the"
            " ellipticities e and -e, and for each of these with a realisation of the noise and with the negative"
            " of that noise. With --no-rings, which omits -e, it is measured twice. With --shear 0 all"
            " measurements are repeated with the galaxy and the noise turned by 90 degrees.",
        ),
    ],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", rich_help_panel=OUTPUT, help="JSON file to write."),
    ],
    density: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=SKY,
            help="Simulate a crowded field with this number of galaxies per square arcminute, and extract them"
            " together; by default each galaxy is isolated. Excludes --selection measured, --prior fitted, --no-rings,"
            " --position-error-arcsec, --facet cell-average and --wraps.",
        ),
    ] = None,
    snr_min: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            rich_help_panel=SKY,
            help="Signal-to-noise ratio below which galaxies are left out.",
        ),
    ] = 10.0,
    selection: Annotated[
        SelectionName,
        typer.Option(
            rich_help_panel=SKY,
            help="Signal-to-noise ratio to which --snr-min applies: catalogue (that of the catalogue's flux, which"
            " shear and noise do not change), or measured (that of the fit, which they change; not with --estimator"
            " metacal).",
        ),
    ] = SelectionName.CATALOGUE,
    flux_min_ujy: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            rich_help_panel=SKY,
            help="Catalogue flux below which galaxies are left out.",
        ),
    ] = 0.0,
    flux_max_ujy: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=SKY,
            help="Catalogue flux above which galaxies are left out.",
        ),
    ] = None,
    shear: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            rich_help_panel=SKY,
            help="Modulus |g| of the shears; with 0 only the additive bias is measured.",
        ),
    ] = 0.02,
    orientations: Annotated[
        int,
        typer.Option(
            min=2,
            rich_help_panel=SKY,
            help="Number of equally spaced orientations of the shear. The first has g1 = g2 > 0: its long axis is"
            " 22.5 deg South of East.",
        ),
    ] = 2,
    rings: Annotated[
        bool,
        typer.Option(
            "--rings/--no-rings",
            rich_help_panel=SKY,
            help="Simulate each galaxy with ellipticity e and with -e. A precise c needs these pairs; without them"
            " the error of m is nearly the same at half the cost.",
        ),
    ] = True,
    legacy_shear: Annotated[
        bool,
        typer.Option(
            "--legacy-shear",
            rich_help_panel=SKY,
            help="Shear the ellipticities but keep the scale lengths, as Rivi & Miller (2018) do in their"
            " simulations; a real lens changes both.",
        ),
    ] = False,
    profile: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            rich_help_panel=SKY,
            help=f"True brightness profile of the simulated galaxies: {PROFILES}. The fitted model is always an"
            " exponential disc.",
        ),
    ] = "exponential",
    prior: Annotated[
        str,
        typer.Option(
            metavar=PRIOR_METAVAR,
            rich_help_panel=METHOD,
            help="Population of galaxies that bayesian assumes: paper (that of Rivi & Miller 2018, from which the"
            " simulated galaxies are drawn), fitted (fitted to other simulated galaxies), or a JSON file.",
        ),
    ] = PAPER,
    wraps: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            rich_help_panel=METHOD,
            help="Estimator that metacal wraps (only with --estimator metacal); the mean by default.",
            show_default=False,
        ),
    ] = None,
    facet: Annotated[
        FacetName,
        typer.Option(
            rich_help_panel=METHOD,
            help="Method of making facets: exact, or cell-average (averages in uv cells as in Rivi & Miller 2018;"
            " only with --estimator mean).",
        ),
    ] = FacetName.EXACT,
    position_error_arcsec: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            rich_help_panel=SKY,
            help="Standard error of the catalogue's positions in l and in m.",
        ),
    ] = 0.0,
    layout: Annotated[
        str,
        typer.Option(
            rich_help_panel=ARRAY,
            help="A known array (see uvshear layouts), or a file of antenna positions.",
        ),
    ] = "ska-mid-aa4",
    declination_deg: Annotated[
        float,
        typer.Option(
            callback=declination, rich_help_panel=ARRAY, help="Declination of the pointing."
        ),
    ] = -30.0,
    hours: Annotated[
        float,
        typer.Option(
            callback=positive,
            rich_help_panel=ARRAY,
            help="Length of the track, centred on transit.",
        ),
    ] = 8.0,
    integration_s: Annotated[
        float,
        typer.Option(
            callback=positive, rich_help_panel=ARRAY, help="Integration time of a sample."
        ),
    ] = 300.0,
    band_mhz: Annotated[
        Pair,
        typer.Option(
            callback=positive_range,
            metavar="LO HI",
            rich_help_panel=ARRAY,
            help="Edges of the band.",
        ),
    ] = (950.0, 1190.0),
    snr_at: Annotated[
        Pair,
        typer.Option(
            callback=positive_pair,
            metavar="UJY SNR",
            rich_help_panel=NOISE,
            help="Flux [uJy] and signal-to-noise ratio, with natural weights, of a round galaxy of median size, from"
            " which the noise follows.",
        ),
    ] = (10.0, 10.0),
    seed: Seed = 1,
    threads: Threads = 0,
    scheduler: SchedulerOption = None,
    log: LogOption = None,
    overwrite: Overwrite = False,
) -> None:
    """Measure the bias m and c of an estimator on simulated galaxies.

    By default each galaxy is simulated in isolation; with --density all galaxies share a crowded field, and are
    extracted together.
    """
    is_measured, is_averaged = selection is SelectionName.MEASURED, facet is FacetName.CELL_AVERAGE
    _refuse(estimator, shear, is_measured=is_measured, is_averaged=is_averaged)
    if density is not None:
        _refuse_in_a_crowd(
            {
                "--selection measured": is_measured,
                "--prior fitted": prior == "fitted",
                "--no-rings": not rings,
                "--position-error-arcsec": position_error_arcsec > 0,
                "--facet cell-average": is_averaged,
                "--wraps": wraps is not None,
            }
        )

    from uvshear.bias import Survey, estimate_bias, opposite_shears
    from uvshear.constants import ARCSEC, MICROJANSKY
    from uvshear.execution import Resources, in_processes
    from uvshear.geometry.directions import PhaseCentre
    from uvshear.interferometer.coverage import Track
    from uvshear.interferometer.layout import load_layout
    from uvshear.interferometer.plan import ObservingPlan
    from uvshear.interferometer.spectral_window import Channels
    from uvshear.io.bias_records import write_bias
    from uvshear.io.outputs import check_file
    from uvshear.simulation.lensing import shear_at_fixed_scale_length, shear_galaxies
    from uvshear.simulation.noise_level import GalaxyNoise

    check_file(output, overwrite=overwrite)
    outputs = [output, *checked_log(log, overwrite=overwrite)]
    reserve(context, outputs, [Path(prior), Path(layout)])
    position_sigma = position_error_arcsec * ARCSEC
    method = estimator_named(
        estimator, prior=prior, wraps=wraps, position_sigma=position_sigma, seed=seed
    )
    centre = PhaseCentre(0.0, math.radians(declination_deg))
    survey = Survey(
        ObservingPlan(
            load_layout(layout),
            Track.from_clock(centre, ((-hours * 1800, hours * 1800),), integration_s),
            Channels.from_band(band_mhz[0] * 1e6, band_mhz[1] * 1e6, 1),
        ),
        noise=GalaxyNoise(snr_at[0] * MICROJANSKY, snr_at[1]),
        profile=profile_named_by_option(profile),
        lens=shear_at_fixed_scale_length if legacy_shear else shear_galaxies,
        snr_min=0.0 if is_measured else snr_min,
        measured_snr_min=snr_min if is_measured else 0.0,
        flux_min=flux_min_ujy * MICROJANSKY,
        flux_max=math.inf if flux_max_ujy is None else flux_max_ujy * MICROJANSKY,
        position_sigma=position_sigma,
        has_rings=rings,
        averages_cells=is_averaged,
    )
    executor = executor_of(context, scheduler, in_processes(threads))
    logged = begin_log(context, log, [], overwrite=overwrite)
    with progress_report("simulating and measuring", logged) as progress:
        found = estimate_bias(
            method,
            galaxies=galaxies,
            shear=opposite_shears(shear, orientations),
            seed=seed,
            survey=survey,
            density=density,
            resources=Resources(executor),
            progress=progress,
        )
    write_bias(output, found, provenance(context), overwrite=overwrite)
    with remarks():
        say("\n".join(map(str, (found, *found.bins))))


def _refuse(estimator: str, shear: float, *, is_measured: bool, is_averaged: bool) -> None:
    """Refuse options that cannot be combined."""
    if shear >= 1:
        raise InputError(f"--shear {shear:g}: |g| below 1 is needed")
    if is_averaged and estimator != MEAN:
        raise InputError(
            f"--facet cell-average --estimator {estimator}: facets of cell averages work only with --estimator mean"
        )
    if is_measured and estimator == "metacal":
        raise InputError(
            "--estimator metacal --selection measured: the signal-to-noise ratio that metacal measures, with a"
            " round PSF, is not the one in a table of shapes; use --selection catalogue"
        )


def _refuse_in_a_crowd(given: dict[str, bool]) -> None:
    """Refuse options that are for isolated galaxies."""
    for name, is_given in given.items():
        if is_given:
            raise InputError(
                f"{name}: applies only to isolated galaxies; leave it out, or leave out --density"
            )
