"""``uvshear psf``: the point spread function and the uv coverage of Measurement Sets."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from pathlib import Path
from typing import Annotated

import typer

from uvshear.cli.options import (
    Overwrite,
    Threads,
    all_positive,
    non_negative,
    positive,
    uv_range_of,
)
from uvshear.cli.outputs import reserve
from uvshear.cli.panels import METHOD, OUTPUT, GroupedCommand
from uvshear.cli.psf_table import loss_rows, measure_figures, shape_rows, told
from uvshear.cli.reading import (
    ColumnOption,
    ConjugateOption,
    FieldOption,
    ScansOption,
    reading_of,
)
from uvshear.cli.terminal import say, shorten, show_table
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
from uvshear.errors import InputError

EPILOG = "Example: uvshear psf FIELD.ms --round-psf -o field-psf.png"

SHORT = "Measure the point spread function; draw it and the uv coverage."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("psf", epilog=EPILOG, short_help=SHORT, cls=GroupedCommand)(psf)


def psf(
    context: typer.Context,
    measurement_sets: Annotated[
        list[Path],
        typer.Argument(
            metavar="FIELD.ms...",
            help="Visibilities of one pointing, in one or more Measurement Sets or MSv4 stores (zarr).",
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            rich_help_panel=OUTPUT,
            help="Picture of the PSF; FIELD-psf.png by default.",
        ),
    ] = None,
    uv_output: Annotated[
        Path | None,
        typer.Option(
            rich_help_panel=OUTPUT, help="Picture of the uv coverage; FIELD-uv.png by default."
        ),
    ] = None,
    weight_sigma_arcsec: Annotated[
        list[float] | None,
        typer.Option(
            callback=all_positive,
            rich_help_panel=METHOD,
            help="Standard deviation (sigma) of the Gaussian weight with which the moments of the PSF are"
            " measured; the option may be repeated; 1 and 3 by default.",
            show_default=False,
        ),
    ] = None,
    scale_length_arcsec: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=METHOD,
            help="Scale length of the galaxy for which the loss of information by a weighting or a uv range is shown;"
            " 1 by default.",
            show_default=False,
        ),
    ] = None,
    pixel_arcsec: Annotated[
        float,
        typer.Option(
            callback=positive,
            rich_help_panel=METHOD,
            help="Size of the pixels of the image of the PSF.",
        ),
    ] = 0.1,
    uv_min: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            rich_help_panel=METHOD,
            help="Shortest baseline to use [wavelengths].",
        ),
    ] = 0.0,
    uv_max: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            rich_help_panel=METHOD,
            help="Longest baseline to use [wavelengths]; by default there is no limit.",
        ),
    ] = None,
    weight: WeightOption = WeightName.NATURAL,
    robust: RobustOption = None,
    weight_field_arcmin: WeightFieldOption = None,
    taper_gaussian_arcsec: GaussianTaperOption = None,
    taper_tukey: TukeyTaperOption = None,
    taper_inner_tukey: InnerTukeyTaperOption = None,
    round_psf: RoundPsfOption = False,
    column: ColumnOption = "DATA",
    field: FieldOption = None,
    scans: ScansOption = None,
    conjugate: ConjugateOption = False,
    threads: Threads = 0,
    overwrite: Overwrite = False,
) -> None:
    """Measure the ellipticity and the size of the PSF, and draw it and the uv coverage.

    If a weighting is given, the table also lists the PSF with natural weights and the loss of information on shapes;
    the picture shows the weighted PSF.
    """
    uv_range = uv_range_of(uv_min, uv_max)
    sigmas = weight_sigma_arcsec or [1.0, 3.0]
    choice = WeightChoice(
        weight,
        robust,
        weight_field_arcmin,
        taper_gaussian_arcsec,
        taper_tukey,
        taper_inner_tukey,
        round_psf,
    )
    weightings = choice.weightings(uv_min, uv_max)
    is_weighted = bool(weightings) or not uv_range.is_everything
    if scale_length_arcsec is not None and not is_weighted:
        raise InputError(
            f"--scale-length-arcsec {scale_length_arcsec:g}: sets the galaxy for which the loss of information is"
            " shown, and natural weights lose none; leave it out, or give a weighting or a uv range"
        )
    disc = scale_length_arcsec or 1.0

    from uvshear.constants import ARCSEC
    from uvshear.diagnostics.coverage_sample import sample_coverage
    from uvshear.diagnostics.psf import point_spread_function
    from uvshear.diagnostics.weighting_loss import weighting_loss
    from uvshear.execution import in_threads
    from uvshear.galaxy import Exponential
    from uvshear.imaging import ImageGrid
    from uvshear.interferometer.weighting import TukeyTaper, weighted
    from uvshear.io.observations import open_observation

    stem = measurement_sets[0].name.removesuffix(".ms").removesuffix(".MS")
    psf_picture = output or Path(f"{stem}-psf.png")
    uv_picture = uv_output or Path(f"{stem}-uv.png")
    reserve_pictures(context, (psf_picture, uv_picture), measurement_sets, overwrite=overwrite)
    size = image_size(max(sigmas), pixel_arcsec)
    reading = reading_of(column, field, scans, conjugates=conjugate)
    executor = in_threads(threads)
    natural = open_observation(measurement_sets, reading)
    grid = ImageGrid(size, pixel_arcsec * ARCSEC)
    images = {"natural": point_spread_function(natural, grid, executor=executor)}
    loss = None
    if is_weighted:
        # Visibilities outside the uv range do not count in the density of the others.
        cut = TukeyTaper(uv_range.minimum, uv_range.maximum)
        observation = weighted(natural, (cut, *weightings))
        images["weighted"] = point_spread_function(observation, grid, executor=executor)
        cells = observation.map_baselines(executor)
        loss = told("the shape information", weighting_loss, cells, disc * ARCSEC, Exponential())
    figures = [
        measure_figures(f"{name} weights", image, grid.pixel, sigmas)
        for name, image in images.items()
    ]
    coverage = sample_coverage(natural)
    rows = shape_rows(figures, sigmas)
    if loss is not None:
        rows += loss_rows(loss, disc)
    show_table(f"PSF at the phase centre, {coverage.rows} rows", ("quantity", *images), rows)

    from uvshear.plot import draw_psf, draw_uv_coverage, save

    shown, title = list(images.values())[-1], f"PSF, {shorten(stem)}"
    title += ", weighted" if is_weighted else ""
    picture = draw_psf(shown, grid.pixel, figures[-1].ellipticity, title)
    save(picture, psf_picture, overwrite=overwrite)
    title = f"uv coverage, {shorten(stem)}"
    picture = draw_uv_coverage(coverage.uvw, coverage.frequency, title)
    save(picture, uv_picture, overwrite=overwrite)
    say(f"pictures: {psf_picture}, {uv_picture}")


def reserve_pictures(
    context: typer.Context,
    pictures: tuple[Path, Path],
    measurement_sets: list[Path],
    *,
    overwrite: bool,
) -> None:
    """Refuse pictures that cannot be written, before anything is computed for them, and reserve them."""
    from uvshear.plot import check_picture

    for path in pictures:
        check_picture(path, overwrite=overwrite)
    reserve(context, pictures, measurement_sets)


def image_size(sigma_arcsec: float, pixel_arcsec: float) -> int:
    """Return the side of an image that holds the widest weight [pixels]."""
    size = 2 * round(5 * sigma_arcsec / pixel_arcsec)
    if not 16 <= size <= 16384:
        raise InputError(
            f"--weight-sigma-arcsec {sigma_arcsec:g} --pixel-arcsec {pixel_arcsec:g}:"
            f" would need an image {size} pixels across, but 16 to 16384 are possible; give pixels of about sigma/5"
        )
    return size
