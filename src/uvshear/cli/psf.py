"""``uvshear psf``: the point spread function and the uv coverage of Measurement Sets."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from pathlib import Path
from typing import Annotated

import typer

from uvshear.cli.options import (
    Overwrite,
    Threads,
    non_negative,
    positive,
    thread_count,
    uv_range_of,
)
from uvshear.cli.reading import (
    ColumnOption,
    ConjugateOption,
    FieldOption,
    ScansOption,
    reading_of,
)
from uvshear.cli.terminal import say, shorten, show_table
from uvshear.errors import InputError

EPILOG = "Example: uvshear psf FIELD.ms -o field-psf.png"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("psf", epilog=EPILOG)(psf)


def psf(
    measurement_sets: Annotated[
        list[Path], typer.Argument(metavar="FIELD.ms...", help="One pointing, in one set or more.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Picture of the PSF; by default FIELD-psf.png."),
    ] = None,
    uv_output: Annotated[
        Path | None, typer.Option(help="Picture of the coverage; by default FIELD-uv.png.")
    ] = None,
    weight_sigma_arcsec: Annotated[
        float, typer.Option(callback=positive, help="Of the Gaussian weight of the moments.")
    ] = 3.0,
    pixel_arcsec: Annotated[
        float, typer.Option(callback=positive, help="Of the image of the PSF.")
    ] = 0.1,
    uv_min: Annotated[
        float, typer.Option(callback=non_negative, help="Shortest baseline used [wavelengths].")
    ] = 0.0,
    uv_max: Annotated[
        float | None, typer.Option(callback=positive, help="Longest baseline used [wavelengths].")
    ] = None,
    column: ColumnOption = "DATA",
    field: FieldOption = None,
    scans: ScansOption = None,
    conjugate: ConjugateOption = False,
    threads: Threads = 0,
    overwrite: Overwrite = False,
) -> None:
    """Ellipticity and size of the natural PSF from quadrupole moments, and the uv coverage."""
    uv_range = uv_range_of(uv_min, uv_max)

    from uvshear.constants import ARCSEC
    from uvshear.extraction.psf import point_spread_function, sample_coverage
    from uvshear.imaging import ImageGrid
    from uvshear.interferometer.psf_shape import measure_psf
    from uvshear.io.observations import open_observation
    from uvshear.io.outputs import check_file

    stem = measurement_sets[0].name.removesuffix(".ms").removesuffix(".MS")
    psf_picture = Path(f"{stem}-psf.png") if output is None else output
    uv_picture = Path(f"{stem}-uv.png") if uv_output is None else uv_output
    if psf_picture == uv_picture:
        raise InputError(f"--output and --uv-output: both are {psf_picture}; give two names")
    for path in (psf_picture, uv_picture):
        check_file(path, overwrite=overwrite)
    size = 2 * round(5 * weight_sigma_arcsec / pixel_arcsec)
    if not 16 <= size <= 16384:
        raise InputError(
            f"--weight-sigma-arcsec {weight_sigma_arcsec:g} --pixel-arcsec {pixel_arcsec:g}:"
            f" an image of {size} pixels; pixels of sigma/5 or so are needed"
        )
    reading = reading_of(column, field, scans, conjugates=conjugate)
    observation = open_observation(measurement_sets, reading)
    pixel = pixel_arcsec * ARCSEC
    image = point_spread_function(
        observation, ImageGrid(size, pixel), uv_range, threads=thread_count(threads)
    )
    shape = measure_psf(image, pixel, weight_sigma_arcsec * ARCSEC)
    coverage = sample_coverage(observation)
    rows = (
        ("e1", f"{shape.ellipticity.real:+.4f}"),
        ("e2", f"{shape.ellipticity.imag:+.4f}"),
        ("size R = Q_ll + Q_mm", f"{shape.size / ARCSEC**2:.3f} arcsec2"),
        ("under a weight of sigma", f"{weight_sigma_arcsec:g} arcsec"),
        ("rows", f"{coverage.rows}"),
    )
    show_table("PSF at the phase centre, natural weights", ("quantity", "value"), rows)

    from uvshear.plot import draw_psf, draw_uv_coverage, save

    save(
        draw_psf(image, pixel, shape.ellipticity, f"PSF, {shorten(stem)}"),
        psf_picture,
        overwrite=overwrite,
    )
    save(
        draw_uv_coverage(coverage.uvw, coverage.frequency, f"uv coverage, {shorten(stem)}"),
        uv_picture,
        overwrite=overwrite,
    )
    say(f"pictures: {psf_picture}, {uv_picture}")
