"""``uvshear simulate``: the observation of a catalogue with an array, as a Measurement Set."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import math
import warnings
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.beams import NONE, PrimaryBeamOption, beam_of_dishes
from uvshear.cli.catalogues import (
    ColumnMapOption,
    FluxUnitOption,
    catalogue_of_options,
    file_of,
)
from uvshear.cli.options import (
    Overwrite,
    Pair,
    PairsCommand,
    Seed,
    Threads,
    declination,
    finite,
    fraction,
    hour_angle_ranges,
    non_negative,
    output_option,
    pair_of_numbers,
    positive,
    positive_pair,
    positive_range,
    reduced_shear,
)
from uvshear.cli.outputs import reserve
from uvshear.cli.panels import ARRAY, MODEL, NOISE, SKY
from uvshear.cli.progress_report import LogOption, begin_log, checked_log, progress_report
from uvshear.cli.registered import PROFILES, profile_named_by_option
from uvshear.cli.terminal import say, warn
from uvshear.errors import DataWarning, InputError

if TYPE_CHECKING:
    from uvshear.geometry.directions import PhaseCentre
    from uvshear.interferometer.noise import Noise, Sefd
    from uvshear.io.catalogue import Catalogue
    from uvshear.simulation.noise_level import GalaxyNoise

EPILOG = (
    "Example: uvshear simulate --layout ska-mid-aa4 --catalogue CAT.fits --declination-deg -30 "
    "--hours 8 --integration-s 60 --band-mhz 950 1190 --channels 1 --snr-at 10 10 --seed 1 "
    "-o FIELD.ms"
)


class NoiseOn(StrEnum):
    """Quantity to which the sigma of the radiometer equation applies."""

    STOKES_I = "stokes-i"
    CORRELATION = "correlation"


SHORT = "Simulate an observation of the sources of a catalogue."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("simulate", epilog=EPILOG, short_help=SHORT, cls=PairsCommand)(simulate)


def simulate(
    context: typer.Context,
    layout: Annotated[
        str,
        typer.Option(
            rich_help_panel=ARRAY,
            help="A known array (see uvshear layouts), or a file of antenna positions.",
            show_default=False,
        ),
    ],
    catalogue: Annotated[
        Path,
        typer.Option(
            rich_help_panel=SKY,
            help="Catalogue of galaxies. If it has columns shear1 and shear2, each galaxy is sheared by its own"
            " values.",
            show_default=False,
        ),
    ],
    integration_s: Annotated[
        float,
        typer.Option(
            callback=positive,
            rich_help_panel=ARRAY,
            help="Integration time of a sample.",
            show_default=False,
        ),
    ],
    band_mhz: Annotated[
        Pair,
        typer.Option(
            callback=positive_range,
            metavar="LO HI",
            rich_help_panel=ARRAY,
            help="Edges of the band.",
            show_default=False,
        ),
    ],
    output: Annotated[Path, output_option("Measurement Set to write.")],
    declination_deg: Annotated[
        float | None,
        typer.Option(
            callback=declination,
            rich_help_panel=ARRAY,
            help="Declination of the phase centre; by default that of the catalogue's field.",
        ),
    ] = None,
    ra_deg: Annotated[
        float | None,
        typer.Option(
            callback=finite,
            rich_help_panel=ARRAY,
            help="Right ascension of the phase centre; by default that of the catalogue's field. It is required if the"
            " catalogue has (ra, dec) without a field centre; for (l, m) positions it is 0 by default.",
        ),
    ] = None,
    hours: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=ARRAY,
            help="Length of the track, centred on transit; give either this or --hour-angles.",
        ),
    ] = None,
    hour_angles: Annotated[
        list[str] | None,
        typer.Option(
            callback=hour_angle_ranges,
            metavar="A B",
            rich_help_panel=ARRAY,
            help="Start and end of the track, in hours from transit; the option may be repeated. Give either this"
            " or --hours.",
        ),
    ] = None,
    channels: Annotated[
        int,
        typer.Option(
            callback=positive, rich_help_panel=ARRAY, help="Number of channels in the band."
        ),
    ] = 1,
    shear: Annotated[
        Pair,
        typer.Option(
            callback=reduced_shear,
            metavar="G1 G2",
            rich_help_panel=SKY,
            help="Reduced shear of all galaxies in the frame of local North (TreeCorr's convention for RA and Dec);"
            " it is applied after the catalogue's own shears.",
        ),
    ] = (0.0, 0.0),
    legacy_shear: Annotated[
        bool,
        typer.Option(
            "--legacy-shear",
            rich_help_panel=SKY,
            help="Shear the ellipticities but keep the scale lengths, as Rivi & Miller (2018) do in their"
            " simulations; a real lens changes both.",
        ),
    ] = False,
    snr_at: Annotated[
        Pair | None,
        typer.Option(
            callback=positive_pair,
            metavar="UJY SNR",
            rich_help_panel=NOISE,
            help="Flux [uJy] and signal-to-noise ratio, with natural weights, of a round galaxy of median size, from"
            " which the noise follows. Either this or --sefd-jy is needed, unless --no-noise is given.",
        ),
    ] = None,
    sefd_jy: Annotated[
        str | None,
        typer.Option(
            rich_help_panel=NOISE,
            help="System equivalent flux density: one number for all dishes, or a list DIAMETER:SEFD,DIAMETER:SEFD"
            " with the diameters of the dishes in metres.",
        ),
    ] = None,
    efficiency: Annotated[
        float,
        typer.Option(
            callback=fraction,
            rich_help_panel=NOISE,
            help="With --sefd-jy: system efficiency in the radiometer equation.",
        ),
    ] = 0.9,
    noise_on: Annotated[
        NoiseOn,
        typer.Option(
            rich_help_panel=NOISE,
            help="With --sefd-jy: whether the radiometer equation gives the noise of Stokes I or of each correlation.",
        ),
    ] = NoiseOn.STOKES_I,
    no_noise: Annotated[
        bool,
        typer.Option(
            "--no-noise",
            rich_help_panel=NOISE,
            help="Add no noise, but write the weights that --snr-at or --sefd-jy imply; those of --snr-at 10 10 if"
            " neither is given.",
        ),
    ] = False,
    elevation_limit_deg: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            rich_help_panel=ARRAY,
            help="Elevation below which samples are left out.",
        ),
    ] = 15.0,
    no_elevation_limit: Annotated[
        bool,
        typer.Option(
            "--no-elevation-limit",
            rich_help_panel=ARRAY,
            help="Keep samples at any elevation.",
        ),
    ] = False,
    smearing: Annotated[
        bool,
        typer.Option(
            "--smearing",
            rich_help_panel=MODEL,
            help="Average over channels and integrations, as a correlator does; otherwise each sample is at a"
            " single frequency and time, as in Rivi & Miller (2018).",
        ),
    ] = False,
    primary_beam: PrimaryBeamOption = NONE,
    exact: Annotated[
        bool,
        typer.Option(
            "--exact",
            rich_help_panel=MODEL,
            help="Sum over all galaxies in double precision, as is always done with --no-noise. By default the"
            " visibilities have an rms error of at most 1e-5 of the noise: most are computed from images; with"
            " --smearing or --primary-beam all are summed, in single precision where this is accurate enough.",
        ),
    ] = False,
    profile: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            rich_help_panel=MODEL,
            help=f"Brightness profile of all galaxies: {PROFILES}.",
        ),
    ] = "exponential",
    flux_unit: FluxUnitOption = None,
    column_map: ColumnMapOption = None,
    seed: Seed = 1,
    threads: Threads = 0,
    log: LogOption = None,
    overwrite: Overwrite = False,
) -> None:
    """Simulate an observation of the sources of a catalogue, and write a Measurement Set."""
    if (hours is None) == (not hour_angles):
        raise InputError("--hours or --hour-angles: give one of the two")
    if snr_at is not None and sefd_jy is not None:
        raise InputError("--snr-at and --sefd-jy: give one of the two")
    if snr_at is None and sefd_jy is None and not no_noise:
        raise InputError("--snr-at, --sefd-jy or --no-noise: give one of them to set the noise")
    sefd = None if sefd_jy is None else parse_sefd(sefd_jy)
    if hours is not None:
        ranges: tuple[Pair, ...] = ((-hours / 2 * 3600, hours / 2 * 3600),)
    else:
        pairs = [pair_of_numbers(text) for text in hour_angles or ()]
        ranges = tuple((start * 3600, stop * 3600) for start, stop in pairs)

    from uvshear.execution import in_threads
    from uvshear.interferometer.coverage import Track
    from uvshear.interferometer.layout import load_layout
    from uvshear.interferometer.plan import ObservingPlan
    from uvshear.interferometer.spectral_window import Channels
    from uvshear.io.measurement_set.writer import (
        check_measurement_set_output,
        write_measurement_set,
    )
    from uvshear.pipeline.simulate import simulate as simulate_observation
    from uvshear.progress import Meter, Stage
    from uvshear.simulation.lensing import shear_at_fixed_scale_length, shear_galaxies

    check_measurement_set_output(output, overwrite=overwrite)
    outputs = [output, *checked_log(log, overwrite=overwrite)]
    reserve(context, outputs, [file_of(catalogue), Path(layout)])
    brightness = profile_named_by_option(profile)
    executor = in_threads(threads)
    sources = catalogue_of_options(catalogue, flux_unit, column_map)
    centre = phase_centre_of(sources, ra_deg, declination_deg)
    limit = None if no_elevation_limit else math.radians(elevation_limit_deg)
    array = load_layout(layout)
    plan = ObservingPlan(
        array,
        Track.from_clock(centre, ranges, integration_s, limit),
        Channels.from_band(band_mhz[0] * 1e6, band_mhz[1] * 1e6, channels),
        is_averaged=smearing,
        primary_beam=beam_of_dishes(primary_beam, lambda: array.diameters),
    )
    logged = begin_log(context, log, [file_of(catalogue)], overwrite=overwrite)
    with progress_report("simulating", logged) as progress:
        Meter(progress).begin(Stage("coverage"))
        with warnings.catch_warnings(record=True) as noted:
            warnings.simplefilter("always", DataWarning)
            observation = simulate_observation(
                sources,
                plan,
                noise=_noise(sefd, efficiency, noise_on, snr_at or (10.0, 10.0)),
                shear=complex(*shear),
                lens=shear_at_fixed_scale_length if legacy_shear else shear_galaxies,
                profile=brightness,
                seed=None if no_noise else seed,
                executor=executor,
                exact=exact,
            )
        write_measurement_set(
            output,
            observation,
            overwrite=overwrite,
            executor=executor,
            progress=progress,
        )
    for note in noted:
        warn(str(note.message))
    rows, sources_there = len(observation.coverage), len(observation.galaxies)
    say(f"{output}: {rows} rows, {channels} channels, {sources_there} galaxies")


def _noise(
    sefd: "Sefd | None", efficiency: float, noise_on: NoiseOn, snr_at: Pair
) -> "Noise | GalaxyNoise":
    from uvshear.constants import MICROJANSKY
    from uvshear.interferometer.noise import CorrelationNoise, StokesINoise
    from uvshear.simulation.noise_level import GalaxyNoise

    if sefd is None:
        return GalaxyNoise(flux=snr_at[0] * MICROJANSKY, snr=snr_at[1])
    kind = StokesINoise if noise_on is NoiseOn.STOKES_I else CorrelationNoise
    return kind(sefd, efficiency)


def phase_centre_of(
    sources: "Catalogue", ra_deg: float | None, declination_deg: float | None
) -> "PhaseCentre":
    """Take the phase centre from the options, else from the catalogue."""
    from uvshear.geometry.directions import PhaseCentre

    field = sources.field_centre
    if declination_deg is None and field is None:
        raise InputError("--declination-deg: is needed, because the catalogue has no field centre")
    ra = 0.0 if field is None else field.ra
    if ra_deg is not None:
        ra = math.radians(ra_deg)
    elif field is None and sources.ra is not None:
        raise InputError("--ra-deg: is needed, because the catalogue has no field centre")
    if declination_deg is not None:
        return PhaseCentre(ra, math.radians(declination_deg))
    assert field is not None
    return PhaseCentre(ra, field.dec)


def parse_sefd(text: str) -> "Sefd":
    """Read one SEFD, or one for each diameter as DIAMETER:SEFD,DIAMETER:SEFD."""
    try:
        if ":" not in text:
            sefd: Sefd = float(text)
            values = [float(text)]
        else:
            pairs = [part.split(":") for part in text.split(",")]
            sefd = tuple((float(diameter), float(value)) for diameter, value in pairs)
            values = [number for pair in sefd for number in pair]
    except ValueError:
        values = []
    if not values or not all(0 < value < math.inf for value in values):
        raise InputError(
            f"--sefd-jy {text}: a positive number of Jy, or DIAMETER:SEFD,DIAMETER:SEFD, is needed"
        )
    return sefd
