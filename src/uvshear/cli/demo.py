"""``uvshear demo``: from a random sky to a shear, with pictures, in a minute or two."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import json
import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from uvshear.cli.options import Overwrite, Threads
from uvshear.cli.terminal import say, show_table
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.diagnostics.slope import Slope, Slopes
    from uvshear.typing import Array, Complex, Float

EPILOG = "Example: uvshear demo my-demo"

CATALOGUE, FIELD, SHAPES, IMAGE, SHEAR, SHEAR_OF_THE_MEAN, SLOPES = (
    "catalogue.fits",
    "field.ms",
    "shapes.fits",
    "residual-image.fits",
    "shear.json",
    "shear-mean.json",
    "slopes.ecsv",
)
BESIDE_SHAPES = ("shapes.stats.fits", "shapes.sky.fits")
FILES = (CATALOGUE, FIELD, SHAPES, *BESIDE_SHAPES, IMAGE, SHEAR, SHEAR_OF_THE_MEAN, SLOPES)
PICTURES = (
    "layout",
    "uv-coverage",
    "psf",
    "residual-image",
    "ellipticity",
    "residuals",
    "shear",
)

UNFINISHED: Final = ".uvshear-demo-unfinished"
"""File in the directory of a demo that has not come to its end: the next demo may replace the files there."""

INTEGRATION_S: Final = 900
"""32 samples in 8 h: 617 792 rows; 60 s would be 9.3 million."""

DECLINATION_DEG: Final = -30

TRUE_SHEAR: Final = 0.05 + 0.03j
"""Reduced shear of all galaxies in the frame of local North."""

COMPUTING: Final = frozenset({"simulate", "psf", "measure"})
"""Commands with the option --threads."""

SHORT = "Simulate and measure a small field, and compare with the truth."


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
    """Simulate a 6' field of SKA-Mid AA4, measure it, and compare the result with the truth."""
    if directory.exists() and not directory.is_dir():
        raise InputError(f"{directory}: is a file; a directory is needed")
    names = (*FILES, *(f"{name}.png" for name in PICTURES))
    there = [directory / name for name in names if os.path.lexists(directory / name)]
    # An earlier demo that did not come to its end left these files.
    is_left = (directory / UNFINISHED).is_file()
    if there and not (overwrite or is_left):
        raise InputError(f"{there[0]}: exists already; give --overwrite or another directory")
    try:
        directory.mkdir(parents=True, exist_ok=True)
        if not there:
            (directory / UNFINISHED).touch()
    except OSError as error:
        raise InputError(f"{directory}: cannot be created: {error.strerror}") from error
    for command in commands(directory):
        _run(command, threads, overwrite or is_left)
    _compare(directory, overwrite or is_left)
    (directory / UNFINISHED).unlink(missing_ok=True)


def commands(directory: Path) -> tuple[tuple[str, ...], ...]:
    """Return the commands that the demo runs, as a user would type them."""
    catalogue, field, shapes, picture = (
        str(directory / name) for name in (CATALOGUE, FIELD, SHAPES, "layout.png")
    )
    shear, shear_of_the_mean = (str(directory / name) for name in (SHEAR, SHEAR_OF_THE_MEAN))
    sky = "--field-arcmin 6 --density 2.8 --flux-ujy 10 200 --ring 1 --seed 1"
    telescope = (
        f"--layout ska-mid-aa4 --declination-deg {DECLINATION_DEG} --hours 8 --band-mhz 950 1190"
    )
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
        ("measure", field, "--catalogue", catalogue, "--keep", "moments", "-o", shapes, *image),
        ("shear", shapes, "--estimator", "moments", "-o", shear),
        ("shear", shapes, "--estimator", "mean", "-o", shear_of_the_mean),
    )


def _run(command: Sequence[str], threads: int, overwrite: bool) -> None:
    """Run one command as the command line does."""
    from uvshear.cli.application import app

    say(f"\n$ uvshear {shlex.join(command)}")
    more = ["--threads", str(threads)] if command[0] in COMPUTING else []
    more += ["--overwrite"] if overwrite else []
    app(args=[*command, *more], prog_name="uvshear", standalone_mode=False)


@dataclass(frozen=True)
class Comparison:
    """Measured and true ellipticities e1 + i e2 of the galaxies of the demo, in the frame of (l, m)."""

    true: "Complex[Array, ' source']"
    measured: "Complex[Array, ' source']"
    error: "Float[Array, 'source 2']"
    flux: "Float[Array, ' source']"

    @classmethod
    def read(cls, directory: Path) -> "Comparison":
        """Read the shapes, and compute the true ones from the catalogue and the shear."""
        import numpy as np

        from uvshear.geometry.directions import PhaseCentre, local_north
        from uvshear.geometry.ellipticity import to_field_frame
        from uvshear.io.catalogue import read_catalogue
        from uvshear.io.shapes import inside, read_shapes
        from uvshear.simulation.lensing import shear_galaxies

        centre = PhaseCentre(0.0, float(np.radians(DECLINATION_DEG)))
        unlensed = read_catalogue(directory / CATALOGUE).galaxies(centre)
        north = local_north(centre, unlensed.l, unlensed.m)
        shear = to_field_frame(np.full(len(unlensed), TRUE_SHEAR), north)
        shapes = read_shapes(directory / SHAPES)
        return cls(
            shear_galaxies(unlensed, shear).ellipticity,
            inside(shapes, "e1") + 1j * inside(shapes, "e2"),
            np.stack([inside(shapes, "e1_err"), inside(shapes, "e2_err")], axis=1),
            unlensed.flux,
        )

    def slopes(self) -> "tuple[Slopes, Slopes]":
        """Return the slopes of e1 and of e2."""
        from uvshear.diagnostics.slope import fit_slopes

        return (
            fit_slopes(self.true.real, self.measured.real, self.error[:, 0]),
            fit_slopes(self.true.imag, self.measured.imag, self.error[:, 1]),
        )


def _compare(directory: Path, overwrite: bool) -> None:
    """Compare the shapes and the shears with the truth: slopes, a table, pictures."""
    from uvshear.plot import draw_ellipticities, draw_residuals, draw_shear, save

    galaxies = Comparison.read(directory)
    slopes = galaxies.slopes()
    _write_slopes(directory / SLOPES, slopes, overwrite)
    estimates = [
        json.loads((directory / name).read_text(encoding="utf-8"))
        for name in (SHEAR, SHEAR_OF_THE_MEAN)
    ]
    _show(slopes, estimates)
    true, measured, error = galaxies.true, galaxies.measured, galaxies.error
    figures = {
        "ellipticity": draw_ellipticities(true, measured, error, slopes),
        "residuals": draw_residuals(true, measured, error, galaxies.flux),
        "shear": draw_shear(
            [str(found["estimator"]) for found in estimates],
            [complex(found["g1"], found["g2"]) for found in estimates],
            [complex(found["g1_err"], found["g2_err"]) for found in estimates],
            TRUE_SHEAR,
        ),
    }
    for name, figure in figures.items():
        save(figure, directory / f"{name}.png", overwrite=overwrite)
    say(
        f"all files are in {directory}; the pictures are {', '.join(f'{name}.png' for name in PICTURES)}"
    )


def _write_slopes(path: Path, slopes: "Sequence[Slopes]", overwrite: bool) -> None:
    from astropy.table import Table

    from uvshear.io.tables import write_table

    first = [fitted.inverse_variance for fitted in slopes]
    population = [fitted.population for fitted in slopes]
    unweighted = [fitted.unweighted for fitted in slopes]
    table = Table(
        {
            "component": ["e1", "e2"],
            "slope": [slope.value for slope in first],
            "slope_err": [slope.error for slope in first],
            "effective_galaxies": [slope.effective_number for slope in first],
            "slope_population": [slope.value for slope in population],
            "slope_population_err": [slope.error for slope in population],
            "slope_unweighted": [slope.value for slope in unweighted],
            "slope_unweighted_err": [slope.error for slope in unweighted],
        },
        meta={
            "definition": "measured on true ellipticity through the origin; slope: weights 1/s^2 with s the error"
            " of e (probably the weights of Rivi & Miller 2018), of effective_galaxies galaxies; slope_population:"
            " weights 1/(s^2 + 0.07)"
        },
    )
    write_table(path, table, overwrite=overwrite)


def _show(slopes: "Sequence[Slopes]", estimates: Sequence[Mapping[str, object]]) -> None:
    """Show slopes and shears in a table, the definition of the paper first."""
    first = [fitted.inverse_variance for fitted in slopes]
    rows = [
        (
            "slope of e, weights 1/s^2 with s the error of e (probably those of Rivi & Miller 2018)",
            *map(_with_error, first),
        ),
        ("effective number of galaxies", *(f"{slope.effective_number:.0f}" for slope in first)),
        (
            "slope of e, weights 1/(s^2 + 0.07)",
            *(_with_error(fitted.population) for fitted in slopes),
        ),
        ("slope of e, unweighted", *(_with_error(fitted.unweighted) for fitted in slopes)),
        ("true shear", f"{TRUE_SHEAR.real:+.4f}", f"{TRUE_SHEAR.imag:+.4f}"),
    ]
    rows += [
        (
            f"shear by {found['estimator']}, {found['n']} galaxies",
            *(f"{found[name]:+.4f} +- {found[f'{name}_err']:.4f}" for name in ("g1", "g2")),
        )
        for found in estimates
    ]
    say("")
    show_table("Measured against true", ("", "component 1", "component 2"), rows)
    say(
        "Faint galaxies lower the slopes: at a low signal-to-noise ratio the posterior mean under a flat prior is"
        " biased towards zero.\nThe estimator `mean` is biased in the same way; `moments` is not."
    )


def _with_error(slope: "Slope") -> str:
    return f"{slope.value:.3f} +- {slope.error:.3f}"
