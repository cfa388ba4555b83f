"""``uvshear measure``: shapes of the galaxies of a catalogue."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import warnings
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.beams import NONE, PrimaryBeamOption, beam_of_observation
from uvshear.cli.catalogues import ColumnMapOption, FluxUnitOption, catalogue_of_options, file_of
from uvshear.cli.clusters import SchedulerOption, executor_of
from uvshear.cli.convergence import tell_convergence
from uvshear.cli.extractions import CONVERGED, ExtractionChoice, FacetName
from uvshear.cli.missing_statistics import tell_missing_statistics
from uvshear.cli.options import (
    Overwrite,
    Threads,
    non_negative,
    options_of_the_state,
    output_option,
    positive,
    provenance,
    uv_range_of,
)
from uvshear.cli.outputs import reserve
from uvshear.cli.panels import DATA, METHOD, MODEL, OUTPUT, RESOURCES, GroupedCommand
from uvshear.cli.progress_report import LogOption, begin_log, checked_log, progress_report
from uvshear.cli.reading import (
    ColumnOption,
    ConjugateOption,
    FieldOption,
    ScansOption,
    SubtractOption,
    reading_of,
)
from uvshear.cli.registered import PROFILES, named_by, profile_named_by_option
from uvshear.cli.residual_images import checked_residual_image, write_residual
from uvshear.cli.terminal import notes_of_warnings, remarks, say
from uvshear.cli.weightings import (
    GaussianTaperOption,
    InnerTukeyTaperOption,
    RobustOption,
    RoundPsfOption,
    TukeyTaperOption,
    WeightChoice,
    WeightFieldOption,
    WeightName,
    WeightOption,
)
from uvshear.errors import InputError, NothingMeasuredWarning

if TYPE_CHECKING:
    from uvshear.galaxy import SizeModel
    from uvshear.interferometer.visibilities import Observation
    from uvshear.io.catalogue import Catalogue
    from uvshear.io.reading import Reading

EPILOG = "Example: uvshear measure FIELD.ms --catalogue CAT.fits --keep moments -o SHAPES.fits"


class NoiseName(StrEnum):
    """Origin of the noise level of the visibilities."""

    WEIGHTS = "weights"
    DATA = "data"


class SizePriorName(StrEnum):
    """Quantity that sets the median of the prior on the scale length."""

    FLUX = "flux"
    CATALOGUE = "catalogue"


SHORT = "Measure the ellipticity of every source of a catalogue."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("measure", epilog=EPILOG, short_help=SHORT, cls=GroupedCommand)(measure)


def measure(
    context: typer.Context,
    measurement_sets: Annotated[
        list[Path],
        typer.Argument(
            metavar="FIELD.ms...",
            help="Visibilities of one pointing, in one or more Measurement Sets or MSv4 stores (zarr).",
        ),
    ],
    catalogue: Annotated[
        Path,
        typer.Option(rich_help_panel=DATA, help="Catalogue of the sources.", show_default=False),
    ],
    output: Annotated[
        Path,
        output_option(
            "Table of shapes to write (.fits, .ecsv or .vot). NAME.sky.fits, and with --keep NAME.stats.fits, are"
            " written beside it."
        ),
    ],
    column: ColumnOption = "DATA",
    subtract: SubtractOption = None,
    field: FieldOption = None,
    scans: ScansOption = None,
    conjugate: ConjugateOption = False,
    noise: Annotated[
        NoiseName,
        typer.Option(
            rich_help_panel=DATA,
            help="Origin of the noise level: the weights as they stand, or the data. With data, the weights are scaled"
            " to the noise that is estimated from the difference of the two parallel hands, the residual of the fitted"
            " sky, and the differences of neighbouring samples.",
        ),
    ] = NoiseName.WEIGHTS,
    ignore_flags: Annotated[
        bool,
        typer.Option(
            "--ignore-flags",
            rich_help_panel=DATA,
            help="Use flagged visibilities as well, for a first look.",
        ),
    ] = False,
    flux_unit: FluxUnitOption = None,
    column_map: ColumnMapOption = None,
    reference_frequency_mhz: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=DATA,
            help="Frequency to which the catalogue's fluxes refer. It overrides the value in the file; 1400 if"
            " neither is given.",
        ),
    ] = None,
    profile: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            rich_help_panel=MODEL,
            help=f"Brightness profile of the galaxies: {PROFILES}.",
        ),
    ] = "exponential",
    size_prior: Annotated[
        SizePriorName,
        typer.Option(
            rich_help_panel=MODEL,
            help="Quantity that sets the median of the prior on the size: the catalogue's flux or its scale_length.",
        ),
    ] = SizePriorName.FLUX,
    position_radius_arcsec: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=MODEL,
            help="Radius about the catalogue's position within which a source must lie; by default the width"
            " (Gaussian sigma) of the peak in the cross-correlation of the data with a round galaxy of median size.",
        ),
    ] = None,
    primary_beam: PrimaryBeamOption = NONE,
    smearing: Annotated[
        bool,
        typer.Option(
            "--smearing/--no-smearing",
            rich_help_panel=MODEL,
            help="Include bandwidth and time smearing in the models of sources (only with --extraction converged).",
        ),
    ] = True,
    extraction: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            rich_help_panel=METHOD,
            help="Algorithm that separates sources: converged (iterated to convergence), paper (one pass, as in"
            " Rivi & Miller 2018), or MODULE:NAME of your own.",
        ),
    ] = CONVERGED,
    facet: Annotated[
        FacetName | None,
        typer.Option(
            rich_help_panel=METHOD,
            help="Method of making facets: exact, which is the default of --extraction converged, or cell-average"
            " (averages in uv cells), which is the default of --extraction paper and possible only there.",
            show_default=False,
        ),
    ] = None,
    facet_size: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=METHOD,
            help="Width of a facet in scale lengths; 45 by default. Facets of cell averages have by default the"
            " numbers of cells of Table 1 in Rivi & Miller (2018).",
        ),
    ] = None,
    passes: Annotated[
        int | None,
        typer.Option(
            callback=positive,
            rich_help_panel=METHOD,
            help="Number of passes over the sources with --extraction paper; 1 by default.",
        ),
    ] = None,
    uv_min: Annotated[
        float | None,
        typer.Option(
            callback=non_negative,
            rich_help_panel=METHOD,
            help="Shortest baseline to use [wavelengths]; by default the converged extraction leaves out baselines"
            " too short to carry information on shapes, unless they are needed for fluxes and sizes.",
            show_default=False,
        ),
    ] = None,
    uv_max: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=METHOD,
            help="Longest baseline to use [wavelengths]; by default the converged extraction reads baselines up to"
            " the longest that carries information on the shape of a source.",
        ),
    ] = None,
    weight: WeightOption = WeightName.NATURAL,
    robust: RobustOption = None,
    weight_field_arcmin: WeightFieldOption = None,
    taper_gaussian_arcsec: GaussianTaperOption = None,
    taper_tukey: TukeyTaperOption = None,
    taper_inner_tukey: InnerTukeyTaperOption = None,
    round_psf: RoundPsfOption = False,
    keep: Annotated[
        str | None,
        typer.Option(
            rich_help_panel=OUTPUT,
            metavar="NAMES",
            help="Comma-separated list of the shear estimators whose statistics are stored beside the shapes: moments,"
            " bayesian, metacal, or MODULE:NAME of your own (only with --extraction converged and natural weights).",
            show_default=False,
        ),
    ] = None,
    residual_image: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.fits",
            rich_help_panel=OUTPUT,
            help="File for two images with natural weights: the dirty image, and the residual image after"
            " subtraction of the fitted sources. A picture of both is written to FILE.png.",
            show_default=False,
        ),
    ] = None,
    log: LogOption = None,
    overwrite: Overwrite = False,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            rich_help_panel=OUTPUT,
            help="Go on from the checkpoint (NAME.checkpoint) that a run with the same inputs and options has left"
            " because it was interrupted. Without this option the measurement begins anew, and the checkpoint of an"
            " earlier run is deleted.",
        ),
    ] = False,
    threads: Threads = 0,
    scheduler: SchedulerOption = None,
    memory_gb: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=RESOURCES,
            help="Memory for the visibilities and images that are processed at the same time [GB]; by default half"
            " of the machine's memory. Results do not depend on it.",
        ),
    ] = None,
) -> None:
    """Measure the ellipticity of every source of a catalogue from the visibilities."""
    uv_range = uv_range_of(uv_min or 0.0, uv_max)
    choice = ExtractionChoice(extraction, facet, facet_size, passes, uv_min)
    weights = WeightChoice(
        weight,
        robust,
        weight_field_arcmin,
        taper_gaussian_arcsec,
        taper_tukey,
        taper_inner_tukey,
        round_psf,
    )

    from uvshear.constants import ARCSEC
    from uvshear.estimators.registry import estimators_of
    from uvshear.execution import Resources, in_copies
    from uvshear.extraction import MeasurementOptions, Method, Model
    from uvshear.io.checkpoint import Checkpoint, checkpoint_beside
    from uvshear.pipeline.measure import measure as measure_sources
    from uvshear.pipeline.measurement import check_outputs, companions
    from uvshear.pipeline.outcome import tally, why_none_was_measured

    check_outputs(output, overwrite=overwrite)
    checkpoint = Checkpoint(checkpoint_beside(output), resume, options_of_the_state(context))
    outputs = [output, *companions(output), checkpoint.directory]
    outputs += checked_log(log, overwrite=overwrite, appends=resume)
    if residual_image is not None:
        outputs += checked_residual_image(residual_image, overwrite=overwrite)
    reserve(context, outputs, [*measurement_sets, file_of(catalogue)])
    with named_by("--keep", keep or ""):
        kept = estimators_of(keep or ())
    method = Method(
        extraction=choice.extraction(),
        uv_range=uv_range,
        weightings=weights.weightings(uv_min or 0.0, uv_max),
    )
    executor = executor_of(context, scheduler, in_copies(threads))
    resources = Resources(executor) if memory_gb is None else Resources(executor, memory_gb * 1e9)
    # Options that cannot be combined are refused before anything is read.
    MeasurementOptions(method=method, resources=resources, keep=kept)
    brightness = profile_named_by_option(profile)
    if primary_beam != NONE and not method.extraction.models_attenuation:
        raise InputError(
            f"--extraction {extraction} --primary-beam {primary_beam}: this extraction cannot model a"
            " primary beam; use --extraction converged"
        )
    sources = catalogue_of_options(
        catalogue,
        flux_unit,
        column_map,
        None if reference_frequency_mhz is None else reference_frequency_mhz * 1e6,
    )
    reading = reading_of(
        column,
        field,
        scans,
        conjugates=conjugate,
        heeds_flags=not ignore_flags,
        subtracted=subtract,
    )
    observation = observed(measurement_sets, reading, noise)
    radius = position_radius_arcsec
    model = Model(
        profile=brightness,
        size=size_of(size_prior, sources, catalogue),
        position_radius=None if radius is None else radius * ARCSEC,
        primary_beam=beam_of_observation(primary_beam, observation),
        smears=smearing,
    )
    inputs = [*measurement_sets, catalogue]
    logged = begin_log(context, log, inputs, overwrite=overwrite, appends=resume)
    with notes_of_warnings(), progress_report("measuring", logged) as progress:
        # It becomes the error with which the command ends.
        warnings.simplefilter("ignore", NothingMeasuredWarning)
        measurement = measure_sources(
            observation,
            sources,
            keep=kept,
            model=model,
            method=method,
            resources=resources,
            progress=progress,
            checkpoint=checkpoint,
        )
    made = provenance(context, *measurement_sets, catalogue)
    measurement.with_provenance(made).write(output, overwrite=overwrite)
    with remarks():
        say(f"{output}: {tally(measurement.shapes)}")
    if cause := why_none_was_measured(measurement.shapes):
        raise InputError(f"{output}: no galaxy was measured: {cause}")
    with remarks():
        tell_convergence(measurement.record)
    with remarks():
        tell_missing_statistics(measurement)
    if residual_image is not None:
        write_residual(measurement, made, residual_image, logged, overwrite=overwrite)


def observed(paths: list[Path], reading: "Reading", noise: NoiseName) -> "Observation":
    """Open the sets, with the noise level of the given origin."""
    from uvshear.interferometer.scaled_observation import scaled_to_its_noise
    from uvshear.io.observations import open_observation

    # Each set has weights, and a noise, of its own.
    prepared = scaled_to_its_noise if noise is NoiseName.DATA else None
    return open_observation(paths, reading, prepared)


def size_of(name: SizePriorName, sources: "Catalogue", path: Path) -> "SizeModel":
    """Return the model of sizes, whose column the catalogue must have."""
    from uvshear.galaxy import CatalogueSize, SizeFluxRelation

    if name is SizePriorName.FLUX:
        return SizeFluxRelation()
    if sources.scale_length is None:
        raise InputError(
            f"{path}: has no column 'scale_length', which --size-prior catalogue needs"
        )
    return CatalogueSize()
