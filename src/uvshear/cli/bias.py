"""``uvshear bias``: how far an estimator of the shear is from the truth."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import cmath
import math
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear import __version__
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
from uvshear.cli.priors import PriorName
from uvshear.cli.profiles import ProfileName, profile_of
from uvshear.cli.terminal import progress_bar, say
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.calibration.bias import Bias
    from uvshear.calibration.crowded import FieldEstimator
    from uvshear.calibration.estimators import Estimator

EPILOG = (
    "Example: uvshear bias --estimator moments --galaxies 20000 --snr-min 10 --shear 0.03 --seed 1 "
    "-o BIAS.json"
)


class CalibratedName(StrEnum):
    """An estimator of the shear of isolated galaxies."""

    MEAN = "mean"
    MOMENTS = "moments"
    BAYESIAN = "bayesian"


class SelectionName(StrEnum):
    """What a cut by the signal-to-noise ratio looks at."""

    CATALOGUE = "catalogue"
    MEASURED = "measured"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("bias", epilog=EPILOG)(bias)


def bias(
    estimator: Annotated[CalibratedName, typer.Option(help="Of the shear.")],
    galaxies: Annotated[
        int,
        typer.Option(
            min=100,
            help="Galaxies, each measured four times behind each shear, eight times without.",
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
        PriorName,
        typer.Option(help="Population of bayesian: the one drawn from, or fitted to a sample."),
    ] = PriorName.PAPER,
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
    from dataclasses import replace

    import numpy as np

    from uvshear.calibration.estimators import SelectedEstimator
    from uvshear.calibration.experiment import Experiment, calibrate
    from uvshear.constants import ARCMIN, ARCSEC, MICROJANSKY
    from uvshear.geometry.directions import PhaseCentre
    from uvshear.interferometer.coverage import Track
    from uvshear.interferometer.layout import load_layout
    from uvshear.interferometer.plan import ObservingPlan
    from uvshear.interferometer.spectral_window import Channels
    from uvshear.io.outputs import check_file, write_json
    from uvshear.measurement import MeasurementOptions
    from uvshear.simulation.field import SquareField
    from uvshear.simulation.lensing import shear_at_fixed_scale_length, shear_galaxies
    from uvshear.simulation.noise_level import GalaxyNoise
    from uvshear.simulation.population import Population, draw_population
    from uvshear.trials import beam_of, calibrate_crowded, crowded_field

    check_file(output, overwrite=overwrite)
    if shear >= 1:
        raise InputError(f"--shear {shear:g}: |g| below 1 is needed")
    is_learning = prior is PriorName.FITTED
    if is_learning and estimator is not CalibratedName.BAYESIAN:
        raise InputError(f"--prior fitted: {estimator.value} has no prior; bayesian has")
    if density is not None:
        refuse_in_a_crowd(
            {
                "--selection measured": selection is SelectionName.MEASURED,
                "--prior fitted": is_learning,
                "--no-rings": not rings,
                "--position-error-arcsec": position_error_arcsec > 0,
            }
        )
    centre = PhaseCentre(0.0, math.radians(declination_deg))
    track = Track.from_clock(centre, ((-hours * 1800, hours * 1800),), integration_s)
    plan = ObservingPlan(
        load_layout(layout),
        track,
        Channels.from_band(band_mhz[0] * 1e6, band_mhz[1] * 1e6, 1),
    )
    shears = shears_of(shear, orientations)
    flux_min = flux_min_ujy * MICROJANSKY
    flux_max = math.inf if flux_max_ujy is None else flux_max_ujy * MICROJANSKY
    population = Population()
    noise = GalaxyNoise(snr_at[0] * MICROJANSKY, snr_at[1])
    lens = shear_at_fixed_scale_length if legacy_shear else shear_galaxies
    if density is not None:
        drawn = draw_population(
            population,
            SquareField(math.sqrt(galaxies / density) * ARCMIN),
            number=galaxies,
            rng=np.random.default_rng(seed),
        )
        crowd = crowded_field(
            plan,
            drawn,
            shears,
            noise=noise,
            snr_min=snr_min,
            seed=seed,
            threads=thread_count(threads),
        )
        crowd = replace(
            crowd,
            used=crowd.used & (drawn.flux >= flux_min) & (drawn.flux <= flux_max),
            lens=lens,
            profile=profile_of(profile),
        )
        options = MeasurementOptions(threads=thread_count(threads))
        with progress_bar("calibrating") as progress:
            biases = calibrate_crowded(crowd, field_estimator_of(estimator), options, progress)
    else:
        experiment = Experiment(
            beam=beam_of(plan, population, noise=noise, threads=thread_count(threads)),
            shears=shears,
            population=population,
            profile=profile_of(profile),
            lens=lens,
            snr_min=snr_min if selection is SelectionName.CATALOGUE else 0.0,
            flux_min=flux_min,
            flux_max=flux_max,
            position_sigma=position_error_arcsec * ARCSEC,
            has_rings=rings,
            seed=seed,
        )
        one = estimator_of(estimator, prior, experiment.position_sigma)
        method = SelectedEstimator(one, snr_min) if selection is SelectionName.MEASURED else one
        with progress_bar("calibrating") as progress:
            biases = calibrate(
                experiment,
                method,
                galaxies,
                thread_count(threads),
                progress,
            )
    say("\n".join(map(describe, biases)))
    record = biases[0].record() | {
        "estimator": estimator.value,
        "shear": shear,
        "orientations": orientations,
        "rings": rings,
        "legacy_shear": legacy_shear,
        "profile": profile.value,
        "prior": prior.value,
        "density": density,
        "snr_min": snr_min,
        "selection": selection.value,
        "flux_min_ujy": flux_min_ujy,
        "flux_max_ujy": flux_max_ujy,
        "declination_deg": declination_deg,
        "seed": seed,
        "version": __version__,
        "bins": [{"flux": one.name, **one.record()} for one in biases[1:]],
    }
    write_json(output, record, overwrite=overwrite)


def shears_of(modulus: float, orientations: int) -> tuple[complex, ...]:
    """Shears of one modulus in directions equally spaced; none is one shear of zero."""
    angles = [math.pi / 4 + 2 * math.pi * k / orientations for k in range(orientations)]
    return tuple(cmath.rect(modulus, angle) for angle in angles) if modulus else (0j,)


def refuse_in_a_crowd(given: Mapping[str, bool]) -> None:
    """Refuse options that are for galaxies alone in the beam."""
    for name, is_given in given.items():
        if is_given:
            raise InputError(f"{name}: is for galaxies alone in the beam; leave out --density")


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


def estimator_of(name: CalibratedName, prior: PriorName, position_sigma: float) -> "Estimator":
    """Return the estimator of a name."""
    from uvshear.calibration.estimators import (
        BayesianEstimator,
        MeanEstimator,
        MomentEstimator,
    )

    if name is CalibratedName.MOMENTS:
        return MomentEstimator(position_sigma)
    if name is CalibratedName.BAYESIAN:
        return BayesianEstimator(is_learning=prior is PriorName.FITTED)
    return MeanEstimator()


def field_estimator_of(name: CalibratedName) -> "FieldEstimator":
    """Return the estimator of a name for galaxies of a field."""
    from uvshear.calibration.crowded import FieldBayesian, FieldMean, FieldMoments

    kinds = {
        CalibratedName.MEAN: FieldMean,
        CalibratedName.MOMENTS: FieldMoments,
        CalibratedName.BAYESIAN: FieldBayesian,
    }
    return kinds[name]()
