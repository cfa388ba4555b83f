"""``uvshear measure``: shapes of the galaxies of a catalogue."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.beams import BeamName, PrimaryBeamOption, beam_of
from uvshear.cli.options import (
    Output,
    Overwrite,
    Threads,
    field_of,
    non_negative,
    positive,
    provenance,
    thread_count,
    uv_range_of,
)
from uvshear.cli.profiles import ProfileName, profile_of
from uvshear.cli.terminal import progress_bar, say, shorten, warn
from uvshear.constants import MICROJANSKY
from uvshear.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from uvshear.extraction.residual_image import DirtyAndResidual
    from uvshear.galaxy import Profile
    from uvshear.measurement import Extraction
    from uvshear.measurement.keep import Statistic

EPILOG = "Example: uvshear measure FIELD.ms --catalogue CAT.fits -o SHAPES.fits"


RELEASED = 0.5
"""Move of a released sky, over the noise, above which the user is warned."""


class ExtractionName(StrEnum):
    """How sources are told apart."""

    CONVERGED = "converged"
    PAPER = "paper"


class FacetName(StrEnum):
    """How a facet is made."""

    EXACT = "exact"
    CELL_AVERAGE = "cell-average"


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
    column: Annotated[str, typer.Option(help="Column of visibilities.")] = "DATA",
    field: Annotated[
        str | None, typer.Option(help="Field (name or number), where a set holds several.")
    ] = None,
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
            help="Dirty image, and what is left without the sources found; with a picture, FILE.png.",
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

    from uvshear.constants import ARCSEC
    from uvshear.galaxy import CatalogueSize, SizeFluxRelation
    from uvshear.io.catalogue import read_catalogue
    from uvshear.io.images import write_residual_image
    from uvshear.io.observations import dish_diameters, open_observation
    from uvshear.io.outputs import check_file
    from uvshear.io.shapes import write_shapes
    from uvshear.io.statistics import keep_statistics, statistics_path
    from uvshear.io.tables import check_table_name
    from uvshear.measurement import MeasurementOptions
    from uvshear.measurement.options import half_of_memory
    from uvshear.measurement.residual_image import image_residual
    from uvshear.pipeline import extract, tabulate

    check_table_name(output)
    check_file(output, overwrite=overwrite, inputs=(catalogue,))
    if statistics:
        check_file(statistics_path(output), overwrite=overwrite, inputs=(catalogue,))
    if residual_image is not None:
        check_residual_image(residual_image, output, catalogue, overwrite=overwrite)
    frequency = None if reference_frequency_mhz is None else reference_frequency_mhz * 1e6
    sources = read_catalogue(catalogue, flux_unit=flux_unit, reference_frequency=frequency)
    if size_prior is SizePriorName.CATALOGUE and sources.scale_length is None:
        raise InputError(
            f"{catalogue}: has no column 'scale_length', which --size-prior catalogue needs"
        )
    observation = open_observation(
        measurement_sets, column, field_of(field), heeds_flags=not ignore_flags
    )
    options = MeasurementOptions(
        extraction=way,
        profile=profile_of(profile),
        size=SizeFluxRelation() if size_prior is SizePriorName.FLUX else CatalogueSize(),
        uv_range=uv_range,
        smears=smearing,
        primary_beam=beam_of(
            primary_beam, dish_diameters(measurement_sets), str(measurement_sets[0])
        ),
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
    tell_remarks(measurement_sets, column, field_of(field))
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


def tell_remarks(paths: list[Path], column: str, field: int | str | None) -> None:
    """Say what a user should know of sets that are measured all the same."""
    from uvshear.io.inspection import inspect
    from uvshear.io.remarks import remarks_on

    for path in paths:
        for content in inspect(path, column, field).fields:
            for remark in remarks_on(content):
                warn(remark)


def statistics_of(
    keep: str | None, extraction: ExtractionName, profile: "Profile"
) -> "tuple[Statistic, ...]":
    """Return the statistics of names joined by commas; likelihoods are of the ``profile``."""
    from uvshear.measurement.keep import LikelihoodStatistic, MomentStatistic
    from uvshear.measurement.metacal import MetacalStatistic

    if keep is None:
        return ()
    if extraction is not ExtractionName.CONVERGED:
        raise InputError(f"--keep {keep}: only --extraction converged keeps statistics")
    known: dict[str, Statistic] = {
        "likelihood": LikelihoodStatistic(profile),
        "moments": MomentStatistic(),
        "metacal": MetacalStatistic(profile),
    }
    for name in keep.split(","):
        if name not in known:
            raise InputError(f"--keep {keep}: '{name}' is not known; {', '.join(known)} are")
    return tuple(one for name, one in known.items() if name in keep.split(","))


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


def extraction_of(
    name: ExtractionName,
    facet: FacetName | None,
    facet_size: float | None,
    rounds: int | None,
    uv_min: float | None = None,
) -> "Extraction":
    """Return the way of telling sources apart; facets are ``facet_size`` scale lengths wide, if given."""
    if name is ExtractionName.CONVERGED:
        if facet is FacetName.CELL_AVERAGE:
            raise InputError(
                "--extraction converged --facet cell-average: its facets are exact;"
                " --extraction paper is needed, or --facet exact"
            )
        if rounds is not None:
            raise InputError(
                f"--extraction converged --rounds {rounds}: it goes on until nothing changes;"
                " --extraction paper is needed, or no --rounds"
            )
        return _converged(facet_size, uv_min)
    return _paper(facet or FacetName.CELL_AVERAGE, facet_size, rounds or 1)


def _converged(facet_size: float | None, uv_min: float | None) -> "Extraction":
    from uvshear.measurement import ConvergedExtraction

    # A shortest baseline that is asked for, 0 too, is taken at its word.
    usual = ConvergedExtraction()
    return ConvergedExtraction(
        scale_lengths=usual.scale_lengths if facet_size is None else facet_size,
        shortest=usual.shortest if uv_min is None else uv_min,
    )


def _paper(facet: FacetName, facet_size: float | None, rounds: int) -> "Extraction":
    from uvshear.extraction.cell_average import CellAverageFacets, PaperTable, ScaleLengths
    from uvshear.extraction.exact import ExactFacets
    from uvshear.measurement import PaperExtraction

    if facet is FacetName.EXACT:
        exact = ExactFacets() if facet_size is None else ExactFacets(facet_size)
        return PaperExtraction(exact, rounds)
    rule = PaperTable() if facet_size is None else ScaleLengths(facet_size)
    return PaperExtraction(CellAverageFacets(rule), rounds)
