"""``uvshear bias``: how far an estimator of the shear is from the truth."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import cmath
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear import __version__
from uvshear.cli.calibrated import (
    SelectionName,
    WrappedName,
    estimator_of,
    field_estimator_of,
    refuse_estimator,
    refuse_in_a_crowd,
    refuse_shear,
)
from uvshear.cli.names import EstimatorName, FacetName
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
    thread_count,
)
from uvshear.cli.priors import FILE, FITTED, METAVAR, PAPER, Prior
from uvshear.cli.profiles import ProfileName, profile_of
from uvshear.cli.terminal import progress_bar, say

if TYPE_CHECKING:
    from uvshear.bias.bias import Bias

EPILOG = (
    "Example: uvshear bias --estimator moments --galaxies 20000 --snr-min 10 --shear 0.03 --seed 1 "
    "-o BIAS.json"
)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("bias", epilog=EPILOG)(bias)


def bias(
    estimator: Annotated[EstimatorName, typer.Option(help="Of the shear.")],
    galaxies: Annotated[
        int,
        typer.Option(
            min=100,
            help="Galaxies, each measured four times behind each shear; without one, eight times alone.",
        ),
    ],
    output: Annotated[Path, typer.Option("-o", "--output", help="JSON file to write.")],
    density: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            help="Galaxies a square arcminute, together in the beam and extracted; else each alone.",
        ),
    ] = None,
    snr_min: Annotated[
        float,
        typer.Option(callback=non_negative, help="Leave out galaxies whose flux makes for less."),
    ] = 10.0,
    selection: Annotated[
        SelectionName,
        typer.Option(
            help="What the SNR is of: the catalogue's flux, or the fit, which shear moves."
        ),
    ] = SelectionName.CATALOGUE,
    flux_min_ujy: Annotated[
        float, typer.Option(callback=non_negative, help="Leave out fainter galaxies.")
    ] = 0.0,
    flux_max_ujy: Annotated[
        float | None, typer.Option(callback=positive, help="Leave out brighter galaxies.")
    ] = None,
    shear: Annotated[
        float, typer.Option(callback=non_negative, help="Modulus |g|; 0 for the additive bias.")
    ] = 0.02,
    orientations: Annotated[
        int, typer.Option(min=2, help="Directions of g, equally spaced, the first at 22.5 deg.")
    ] = 2,
    rings: Annotated[
        bool,
        typer.Option(
            "--rings/--no-rings", help="See galaxies with e and -e, for c; m needs only one."
        ),
    ] = True,
    legacy_shear: Annotated[
        bool,
        typer.Option("--legacy-shear", help="Keep alpha under shear, as the paper; no true shear."),
    ] = False,
    profile: Annotated[
        ProfileName, typer.Option(help="True profile; exponential discs are fitted.")
    ] = ProfileName.EXPONENTIAL,
    prior: Annotated[
        str,
        typer.Option(
            metavar=METAVAR,
            help="Population of bayesian: the paper's, drawn from; fitted to a sample; or of a JSON file.",
        ),
    ] = PAPER,
    wraps: Annotated[
        WrappedName | None,
        typer.Option(help="What metacal calibrates; by default the mean.", show_default=False),
    ] = None,
    facet: Annotated[
        FacetName, typer.Option(help="Exact, or the paper's averages in cells (mean only).")
    ] = FacetName.EXACT,
    position_error_arcsec: Annotated[
        float, typer.Option(callback=non_negative, help="Of the catalogue, in l and in m.")
    ] = 0.0,
    layout: Annotated[str, typer.Option(help="A known array, or a file of positions.")] = (
        "ska-mid-aa4"
    ),
    declination_deg: Annotated[
        float, typer.Option(callback=declination, help="Of the pointing.")
    ] = -30.0,
    hours: Annotated[float, typer.Option(callback=positive, help="Track, about transit.")] = 8.0,
    integration_s: Annotated[float, typer.Option(callback=positive, help="Of a sample.")] = 300.0,
    band_mhz: Annotated[
        Pair, typer.Option(callback=positive_range, metavar="LO HI", help="Edges of the band.")
    ] = (950.0, 1190.0),
    snr_at: Annotated[
        Pair,
        typer.Option(
            callback=positive_pair,
            metavar="UJY SNR",
            help="Noise by the SNR of the median galaxy of a flux.",
        ),
    ] = (10.0, 10.0),
    seed: Seed = 1,
    threads: Threads = 0,
    overwrite: Overwrite = False,
) -> None:
    """Measure m and c of an estimator, on galaxies alone or in a crowd, behind opposite shears with the same noise."""
    from uvshear.bias.experiment import calibrate
    from uvshear.bias.survey import Survey, calibrate_crowded
    from uvshear.constants import ARCSEC, MICROJANSKY
    from uvshear.extraction import MeasurementOptions
    from uvshear.geometry.directions import PhaseCentre
    from uvshear.interferometer.coverage import Track
    from uvshear.interferometer.layout import load_layout
    from uvshear.interferometer.plan import ObservingPlan
    from uvshear.interferometer.spectral_window import Channels
    from uvshear.io.outputs import check_file, write_json
    from uvshear.io.population import population_record
    from uvshear.simulation.lensing import shear_at_fixed_scale_length, shear_galaxies
    from uvshear.simulation.noise_level import GalaxyNoise

    check_file(output, overwrite=overwrite, inputs=[Path(prior)])
    is_measured, is_averaged = selection is SelectionName.MEASURED, facet is FacetName.CELL_AVERAGE
    refuse_shear(shear, is_averaged=is_averaged)
    refuse_estimator(estimator, wraps, prior, is_measured=is_measured, is_averaged=is_averaged)
    assumed = Prior.from_option(prior)
    if density is not None:
        refuse_in_a_crowd(
            {
                "--selection measured": is_measured,
                f"--prior {FITTED}": assumed.is_fitted,
                "--no-rings": not rings,
                "--position-error-arcsec": position_error_arcsec > 0,
                "--facet cell-average": is_averaged,
                "--wraps": wraps is not None,
            }
        )
    centre = PhaseCentre(0.0, math.radians(declination_deg))
    track = Track.from_clock(centre, ((-hours * 1800, hours * 1800),), integration_s)
    channels = Channels.from_band(band_mhz[0] * 1e6, band_mhz[1] * 1e6, 1)
    survey = Survey(
        ObservingPlan(load_layout(layout), track, channels),
        shears_of(shear, orientations),
        noise=GalaxyNoise(snr_at[0] * MICROJANSKY, snr_at[1]),
        profile=profile_of(profile),
        lens=shear_at_fixed_scale_length if legacy_shear else shear_galaxies,
        snr_min=0.0 if is_measured else snr_min,
        flux_min=flux_min_ujy * MICROJANSKY,
        flux_max=math.inf if flux_max_ujy is None else flux_max_ujy * MICROJANSKY,
        seed=seed,
        threads=thread_count(threads),
    )
    with progress_bar("calibrating") as progress:
        if density is not None:
            options = MeasurementOptions(threads=survey.threads)
            method = field_estimator_of(estimator, assumed, seed)
            (biases,) = calibrate_crowded(
                survey.crowd(galaxies, density), [method], options, progress
            )
        else:
            position_sigma = position_error_arcsec * ARCSEC
            experiment = replace(
                survey.alone(averages_cells=is_averaged),
                position_sigma=position_sigma,
                has_rings=rings,
            )
            one = estimator_of(
                estimator, wraps, assumed, position_sigma, snr_min if is_measured else None
            )
            biases = calibrate(experiment, one, galaxies, survey.threads, progress)
    say("\n".join(map(describe, biases)))
    record = biases[0].record() | {
        "estimator": estimator.value,
        "galaxies": galaxies,
        "shear": shear,
        "orientations": orientations,
        "rings": rings,
        "legacy_shear": legacy_shear,
        "profile": profile.value,
        "prior": assumed.source,
        "population": population_record(assumed.population) if assumed.source == FILE else None,
        "wraps": (wraps or WrappedName.MEAN).value if estimator is EstimatorName.METACAL else None,
        "facet": facet.value,
        "density": density,
        "snr_min": snr_min,
        "selection": selection.value,
        "flux_min_ujy": flux_min_ujy,
        "flux_max_ujy": flux_max_ujy,
        "position_error_arcsec": position_error_arcsec,
        "layout": layout,
        "declination_deg": declination_deg,
        "hours": hours,
        "integration_s": integration_s,
        "band_mhz": band_mhz,
        "snr_at": snr_at,
        "seed": seed,
        "version": __version__,
        "bins": [{"flux": one.name, **one.record()} for one in biases[1:]],
    }
    write_json(output, record, overwrite=overwrite)


def shears_of(modulus: float, orientations: int) -> tuple[complex, ...]:
    """Shears of one modulus in directions equally spaced; none is one shear of zero."""
    angles = [math.pi / 4 + 2 * math.pi * k / orientations for k in range(orientations)]
    return tuple(cmath.rect(modulus, angle) for angle in angles) if modulus else (0j,)


def describe(one: "Bias") -> str:
    """One line for the terminal."""
    parts = [
        f"{name}{i + 1} = {value[i]:+.5f} +- {error[i]:.5f}"
        for name, value, error in (("m", one.m, one.m_err), ("c", one.c, one.c_err))
        for i in (0, 1)
        if math.isfinite(value[i])
    ]
    failures = f", {one.failed} measurements failed" if one.failed else ""
    return f"{one.name}: {', '.join(parts)} ({one.n} galaxies{failures})"
