"""``uvshear demo``: from a random sky to shear, with pictures, in a minute or two."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import json
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from uvshear.cli.options import Overwrite, Threads
from uvshear.cli.terminal import say, show_table
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.diagnostics.slope import Slope

EPILOG = "Example: uvshear demo my-demo"

CATALOGUE, FIELD, SHAPES, IMAGE, SHEAR, SLOPES = (
    "catalogue.fits",
    "field.ms",
    "shapes.fits",
    "residual-image.fits",
    "shear.json",
    "slopes.ecsv",
)
PICTURES = (
    "layout",
    "uv-coverage",
    "psf",
    "residual-image",
    "ellipticity",
    "residuals",
    "shear",
)

INTEGRATION_S: Final = 900
"""32 samples in 8 h: 617 792 rows; 60 s would be 9.3 million."""

TRUE_SHEAR: Final = 0.05 - 0.03j

COMPUTING: Final = frozenset({"simulate", "psf", "measure"})
"""Commands that take threads."""

SHORT = "Simulate a small field, measure it, compare with the truth."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("demo", epilog=EPILOG, short_help=SHORT)(demo)


def demo(
    directory: Annotated[
        Path, typer.Argument(help="Directory for all files; it is created if needed.")
    ] = (Path("uvshear-demo")),
    threads: Threads = 0,
    overwrite: Overwrite = False,
) -> None:
    """Simulate a 6' field of SKA-Mid AA4, measure it, and compare with the truth."""
    if directory.exists() and not directory.is_dir():
        raise InputError(f"{directory}: is a file; a directory is needed")
    names = (CATALOGUE, FIELD, SHAPES, IMAGE, SHEAR, SLOPES, *(f"{name}.png" for name in PICTURES))
    there = [directory / name for name in names if (directory / name).exists()]
    if there and not overwrite:
        raise InputError(f"{there[0]}: exists already; give --overwrite or another directory")
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{directory}: cannot be made: {error.strerror}") from error
    for command in commands(directory):
        _run(command, threads, overwrite)
    _compare(directory, overwrite)


def commands(directory: Path) -> tuple[tuple[str, ...], ...]:
    """List what the demo runs, as a user would type it."""
    catalogue, field, shapes, shear, picture = (
        str(directory / name) for name in (CATALOGUE, FIELD, SHAPES, SHEAR, "layout.png")
    )
    sky = "--field-arcmin 6 --density 2.8 --flux-ujy 10 200 --ring 1 --seed 1"
    telescope = "--layout ska-mid-aa4 --declination-deg -30 --hours 8 --band-mhz 950 1190"
    samples = f"--integration-s {INTEGRATION_S} --channels 1 --snr-at 10 10 --seed 1"
    lens = f"--shear {TRUE_SHEAR.real:g} {TRUE_SHEAR.imag:g}"
    simulated = (*telescope.split(), *samples.split(), *lens.split())
    image = ("--residual-image", str(directory / IMAGE))
    pictures = (str(directory / "psf.png"), "--uv-output", str(directory / "uv-coverage.png"))
    return (
        ("layouts", "ska-mid-aa4", "-o", picture),
        ("catalogue", *sky.split(), "-o", catalogue),
        ("simulate", "--catalogue", catalogue, *simulated, "-o", field),
        ("psf", field, "-o", *pictures),
        ("measure", field, "--catalogue", catalogue, "-o", shapes, *image),
        ("shear", shapes, "--snr-min", "10", "-o", shear),
    )


def _run(command: Sequence[str], threads: int, overwrite: bool) -> None:
    """Run one command as the command line does."""
    from uvshear.cli.application import app

    say(f"\n$ uvshear {shlex.join(command)}")
    more = ["--threads", str(threads)] if command[0] in COMPUTING else []
    more += ["--overwrite"] if overwrite else []
    app(args=[*command, *more], prog_name="uvshear", standalone_mode=False)


def _compare(directory: Path, overwrite: bool) -> None:
    """Set the shapes against the truth: slopes, shear, pictures."""
    import numpy as np
    from astropy.table import Table

    from uvshear.diagnostics.slope import fit_slope
    from uvshear.geometry.directions import PhaseCentre
    from uvshear.io.catalogue import read_catalogue
    from uvshear.io.shapes import inside, read_shapes
    from uvshear.io.tables import write_table
    from uvshear.plot import draw_ellipticities, draw_residuals, draw_shear, save
    from uvshear.simulation.lensing import shear_galaxies

    centre = PhaseCentre(0.0, float(np.radians(-30.0)))
    intrinsic = read_catalogue(directory / CATALOGUE).galaxies(centre)
    true = shear_galaxies(intrinsic, TRUE_SHEAR).ellipticity
    shapes = read_shapes(directory / SHAPES)
    measured = inside(shapes, "e1") + 1j * inside(shapes, "e2")
    error = np.stack([inside(shapes, "e1_err"), inside(shapes, "e2_err")], axis=1)
    components = ((true.real, measured.real, error[:, 0]), (true.imag, measured.imag, error[:, 1]))
    slopes = [fit_slope(x, y, s) for x, y, s in components]
    plain = [fit_slope(x, y) for x, y, _ in components]
    table = Table(
        {
            "component": ["e1", "e2"],
            "slope": [slope.value for slope in slopes],
            "slope_err": [slope.error for slope in slopes],
            "slope_unweighted": [slope.value for slope in plain],
            "slope_unweighted_err": [slope.error for slope in plain],
        },
        meta={"definition": "measured on true through the origin, weights 1/(s^2 + 0.07)"},
    )
    write_table(directory / SLOPES, table, overwrite=overwrite)
    estimate = json.loads((directory / SHEAR).read_text(encoding="utf-8"))
    say("")
    show_table(
        "Measured against true",
        ("", "component 1", "component 2"),
        (
            ("slope of e, weights 1/(s^2 + 0.07)", *(_with_error(slope) for slope in slopes)),
            ("slope of e, unweighted", *(_with_error(slope) for slope in plain)),
            ("true shear", f"{TRUE_SHEAR.real:+.4f}", f"{TRUE_SHEAR.imag:+.4f}"),
            (
                f"measured shear, {estimate['n']} galaxies",
                f"{estimate['g1']:+.4f} +- {estimate['g1_err']:.4f}",
                f"{estimate['g2']:+.4f} +- {estimate['g2_err']:.4f}",
            ),
        ),
    )
    shear = complex(estimate["g1"], estimate["g2"])
    shear_error = complex(estimate["g1_err"], estimate["g2_err"])
    figures = {
        "ellipticity": draw_ellipticities(true, measured, error, slopes),
        "residuals": draw_residuals(true, measured, error, intrinsic.flux),
        "shear": draw_shear([estimate["estimator"]], [shear], [shear_error], TRUE_SHEAR),
    }
    for name, figure in figures.items():
        save(figure, directory / f"{name}.png", overwrite=overwrite)
    say(f"everything is in {directory}: {', '.join(f'{name}.png' for name in PICTURES)}")


def _with_error(slope: "Slope") -> str:
    return f"{slope.value:.3f} +- {slope.error:.3f}"
