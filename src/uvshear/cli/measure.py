"""``uvshear measure``: shapes of the galaxies of a catalogue."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.beams import BeamName, PrimaryBeamOption, pointed_beam
from uvshear.cli.extractions import ExtractionName, extraction_of, statistics_of
from uvshear.cli.names import FacetName
from uvshear.cli.options import (
    Output,
    Overwrite,
    Threads,
    non_negative,
    positive,
    provenance,
    thread_count,
    uv_range_of,
)
from uvshear.cli.profiles import ProfileName, profile_of
from uvshear.cli.reading import (
    ColumnOption,
    ConjugateOption,
    FieldOption,
    ScansOption,
    SubtractOption,
    reading_of,
)
from uvshear.cli.terminal import progress_bar, say, shorten, warn
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
from uvshear.constants import MICROJANSKY
from uvshear.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from uvshear.diagnostics.residual_image import DirtyAndResidual
    from uvshear.galaxy import SizeModel
    from uvshear.interferometer.visibilities import Observation
    from uvshear.io.catalogue import Catalogue
    from uvshear.io.observations import Reading

EPILOG = "Example: uvshear measure FIELD.ms --catalogue CAT.fits -o SHAPES.fits"


RELEASED = 0.5
"""Move of a released sky, over the noise, above which the user is warned."""


class NoiseName(StrEnum):
    """Where the noise of a visibility comes from."""

    WEIGHTS = "weights"
    DATA = "data"


class SizePriorName(StrEnum):
    """Where the prior on the scale length comes from."""

    FLUX = "flux"
    CATALOGUE = "catalogue"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("measure", epilog=EPILOG)(measure)


def measure(
    context: typer.Context,
    measurement_sets: Annotated[
        list[Path], typer.Argument(metavar="FIELD.ms...", help="One pointing, in one set or more.")
    ],
    catalogue: Annotated[Path, typer.Option(help="Catalogue of the sources.")],
    output: Output,
    uv_min: Annotated[
        float | None,
        typer.Option(
            callback=non_negative,
            help="Shortest baseline used [wavelengths]; by default (converged) the shortest that tells of shapes.",
            show_default=False,
        ),
    ] = None,
    uv_max: Annotated[
        float | None, typer.Option(callback=positive, help="Longest baseline used [wavelengths].")
    ] = None,
    extraction: Annotated[
        ExtractionName,
        typer.Option(help="Until nothing changes, or as Rivi & Miller 2018: one pass."),
    ] = ExtractionName.CONVERGED,
    facet: Annotated[
        FacetName | None,
        typer.Option(
            help="exact (converged), or the paper's averages in uv cells (paper).",
            show_default=False,
        ),
    ] = None,
    facet_size: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            help="Field of view of a facet, in scale lengths; by default the paper's have its Table 1's cells.",
        ),
    ] = None,
    rounds: Annotated[
        int | None,
        typer.Option(callback=positive, help="Passes over the sources; paper only, there 1."),
    ] = None,
    column: ColumnOption = "DATA",
    subtract: SubtractOption = None,
    field: FieldOption = None,
    scans: ScansOption = None,
    conjugate: ConjugateOption = False,
    noise: Annotated[
        NoiseName,
        typer.Option(help="By the weights, or by the data: weights scaled to their scatter."),
    ] = NoiseName.WEIGHTS,
    ignore_flags: Annotated[
        bool, typer.Option("--ignore-flags", help="Take flagged visibilities too, for a look.")
    ] = False,
    smearing: Annotated[
        bool,
        typer.Option(
            "--smearing/--no-smearing",
            help="Model sources as channels and integrations average them (converged).",
        ),
    ] = True,
    primary_beam: PrimaryBeamOption = BeamName.NONE,
    weight: WeightOption = WeightName.NATURAL,
    robust: RobustOption = None,
    weight_field_arcmin: WeightFieldOption = None,
    taper_gaussian_arcsec: GaussianTaperOption = None,
    taper_tukey: TukeyTaperOption = None,
    taper_inner_tukey: InnerTukeyTaperOption = None,
    round_psf: RoundPsfOption = False,
    size_prior: Annotated[
        SizePriorName, typer.Option(help="Prior on the size: by the flux, or scale_length.")
    ] = SizePriorName.FLUX,
    profile: Annotated[
        ProfileName, typer.Option(help="Of the galaxies.")
    ] = ProfileName.EXPONENTIAL,
    position_radius_arcsec: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            help="How far the catalogue's positions may be off; by default the correlation's width.",
        ),
    ] = None,
    flux_unit: Annotated[
        str | None, typer.Option(help="Unit of a flux column that has none (CSV).")
    ] = None,
    reference_frequency_mhz: Annotated[
        float | None,
        typer.Option(callback=positive, help="Of the catalogue's fluxes, whatever it says."),
    ] = None,
    threads: Threads = 0,
    memory_gb: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            help="Memory for what would be worked out again [GB]; by default half of the machine's.",
        ),
    ] = None,
    keep: Annotated[
        str | None,
        typer.Option(
            help="For uvshear shear, kept beside the shapes: likelihood,moments,metacal (converged only).",
            show_default=False,
        ),
    ] = None,
    residual_image: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.fits",
            help="Dirty image (natural weights), and what is left without the sources found; with a picture, FILE.png.",
            show_default=False,
        ),
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Measure the ellipticity of every source of a catalogue from the visibilities."""
    uv_range = uv_range_of(uv_min or 0.0, uv_max)
    way = extraction_of(extraction, facet, facet_size, rounds, uv_min)
    if primary_beam is not BeamName.NONE and extraction is ExtractionName.PAPER:
        raise InputError(
            f"--extraction paper --primary-beam {primary_beam.value}: the paper has no primary beam;"
            " --extraction converged is needed"
        )
    statistics = statistics_of(keep, extraction, profile_of(profile))
    choice = WeightChoice(
        weight,
        robust,
        weight_field_arcmin,
        taper_gaussian_arcsec,
        taper_tukey,
        taper_inner_tukey,
        round_psf,
    )
    weightings = choice.weightings(uv_min or 0.0, uv_max)
    if statistics and weightings:
        raise InputError(
            f"--keep {keep}: what is kept takes the noise for that of natural weights;"
            " no other weighting can be had with it"
        )

    from uvshear.constants import ARCSEC
    from uvshear.extraction import MeasurementOptions
    from uvshear.extraction.options import half_of_memory
    from uvshear.extraction.residual_image import image_residual
    from uvshear.io.catalogue import read_catalogue
    from uvshear.io.images import write_residual_image
    from uvshear.io.outputs import check_file
    from uvshear.io.shapes import write_shapes
    from uvshear.io.statistics import keep_statistics, statistics_path
    from uvshear.io.tables import check_table_name
    from uvshear.pipeline import extract, tabulate

    check_table_name(output)
    check_file(output, overwrite=overwrite, inputs=(catalogue,))
    if statistics:
        check_file(statistics_path(output), overwrite=overwrite, inputs=(catalogue,))
    if residual_image is not None:
        check_residual_image(residual_image, output, catalogue, overwrite=overwrite)
    frequency = None if reference_frequency_mhz is None else reference_frequency_mhz * 1e6
    sources = read_catalogue(catalogue, flux_unit=flux_unit, reference_frequency=frequency)
    reading = reading_of(
        column,
        field,
        scans,
        conjugates=conjugate,
        heeds_flags=not ignore_flags,
        subtracted=subtract,
    )
    observation = observed(measurement_sets, reading, noise)
    options = MeasurementOptions(
        extraction=way,
        profile=profile_of(profile),
        size=size_of(size_prior, sources, catalogue),
        uv_range=uv_range,
        weightings=weightings,
        smears=smearing,
        primary_beam=pointed_beam(primary_beam, measurement_sets, reading),
        position_radius=(
            None if position_radius_arcsec is None else position_radius_arcsec * ARCSEC
        ),
        keep=statistics,
        threads=thread_count(threads),
        memory=half_of_memory() if memory_gb is None else memory_gb * 1e9,
    )
    with progress_bar("measuring") as progress:
        measured_field, extracted = extract(observation, sources, options, progress=progress)
    centre = observation.phase_centre
    shapes = tabulate(sources, measured_field, extracted, centre, options)
    made = provenance(context, *measurement_sets, catalogue)
    shapes.meta.update(made.metadata())
    write_shapes(output, shapes, overwrite=overwrite)
    columns = tuple(name for one in statistics for name in one.columns)
    keep_statistics(output, shapes["id"], columns, extracted.kept, overwrite=overwrite)
    tell_remarks(measurement_sets, reading, noise)
    measured = sum(flag == "ok" for flag in shapes["flag"])
    say(f"{output}: {measured} of {len(shapes)} sources measured")
    tell_convergence(extracted.record)
    if residual_image is not None:
        with progress_bar("imaging") as progress:
            images = image_residual(
                observation, measured_field, extracted, options, progress=progress
            )
        write_residual_image(residual_image, images, centre, made.metadata(), overwrite=overwrite)
        _draw(images, shorten(measurement_sets[0].name), residual_image, overwrite=overwrite)


def observed(paths: list[Path], reading: "Reading", noise: NoiseName) -> "Observation":
    """Open the sets, with the noise that is asked for."""
    from uvshear.interferometer.noise_estimate import scaled_to_its_noise
    from uvshear.io.observations import open_observation

    # Each set has weights, and a noise, of its own.
    prepared = scaled_to_its_noise if noise is NoiseName.DATA else None
    return open_observation(paths, reading, prepared)


def size_of(name: SizePriorName, sources: "Catalogue", path: Path) -> "SizeModel":
    """Return where the prior of the size comes from, if it is there."""
    from uvshear.galaxy import CatalogueSize, SizeFluxRelation

    if name is SizePriorName.FLUX:
        return SizeFluxRelation()
    if sources.scale_length is None:
        raise InputError(
            f"{path}: has no column 'scale_length', which --size-prior catalogue needs"
        )
    return CatalogueSize()


def tell_remarks(paths: list[Path], reading: "Reading", noise: NoiseName) -> None:
    """Say what a user should know of sets that are measured all the same."""
    from uvshear.io.data_warnings import remarks_on
    from uvshear.io.inspection import inspect

    for path in paths:
        for content in inspect(path, reading).fields:
            # Weights that were scaled to the noise are right.
            known = content.noise_over_weights if noise is NoiseName.WEIGHTS else None
            for remark in remarks_on(replace(content, noise_over_weights=known)):
                warn(remark)


def _draw(images: "DirtyAndResidual", title: str, path: Path, *, overwrite: bool) -> None:
    """Draw the images beside their file, and say what is left."""
    from uvshear.plot import draw_residual_image, save

    picture = picture_of(path)
    save(draw_residual_image(images, title), picture, overwrite=overwrite)
    rms, noise = images.rms / MICROJANSKY, images.noise / MICROJANSKY
    say(f"{path}, {picture}: rms of the residual {rms:.4g} uJy/beam, thermal noise {noise:.4g}")


def picture_of(image: Path) -> Path:
    """Name of the picture beside an image."""
    return image.with_suffix(".png")


def check_residual_image(image: Path, output: Path, catalogue: Path, *, overwrite: bool) -> None:
    """Refuse a residual image that cannot be written, or whose picture cannot, before anything is computed."""
    from uvshear.io.images import check_image_name
    from uvshear.io.outputs import check_file

    check_image_name(image)
    for path in (image, picture_of(image)):
        if path.absolute() == output.absolute():
            raise InputError(f"--residual-image {image}: -o is {output} too; give two names")
        check_file(path, overwrite=overwrite, inputs=(catalogue,))


def tell_convergence(record: "Mapping[str, object]") -> None:
    """Say how far the sky still was from settled; a way that does not iterate has nothing to say."""
    left, tolerance = record.get("left_undone"), record.get("tolerance")
    if not isinstance(left, float) or not isinstance(tolerance, float):
        return
    say(
        f"{record['visits']} visits; another would change sources by {left:.2g} of the noise (rms),"
        f" one by {record['left_undone_most']:.2g}"
    )
    if left > tolerance:
        warn(
            f"the sky has not settled: {left:.2g} of the noise is above {tolerance:g};"
            " overlapping galaxies are to be taken with care"
        )
    released = record.get("released")
    if isinstance(released, list) and released[-1] > RELEASED:
        warn(
            f"the sky without priors, which what is kept is of, still moved by {released[-1]:.2g} of the noise (rms):"
            " take shears from it with care"
        )
