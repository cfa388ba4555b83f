"""``uvshear catalogue``: draw a simulated population of galaxies."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import math
from pathlib import Path
from typing import Annotated

import typer

from uvshear.cli.options import (
    Overwrite,
    Pair,
    Seed,
    declination,
    finite,
    output_option,
    positive,
    positive_range,
    provenance,
)
from uvshear.cli.outputs import reserve
from uvshear.cli.terminal import say
from uvshear.errors import InputError

EPILOG = (
    "Example: uvshear catalogue --field-arcmin 6 --density 2.8 --flux-ujy 10 200 --seed 1 "
    "-o CAT.fits"
)

SHORT = "Draw a simulated population of galaxies."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("catalogue", epilog=EPILOG, short_help=SHORT)(catalogue)


def catalogue(
    context: typer.Context,
    field_arcmin: Annotated[
        float,
        typer.Option(
            callback=positive,
            help="Side of the square field, or diameter of the disc.",
            show_default=False,
        ),
    ],
    output: Annotated[Path, output_option("Catalogue to write (.fits, .ecsv or .vot).")],
    density: Annotated[
        float | None,
        typer.Option(
            callback=positive,
            help="Number of galaxies per square arcminute; give either this or --count.",
        ),
    ] = None,
    count: Annotated[
        int | None,
        typer.Option(callback=positive, help="Number of galaxies; give either this or --density."),
    ] = None,
    flux_ujy: Annotated[
        Pair,
        typer.Option(
            callback=positive_range,
            metavar="LO HI",
            help="Smallest and largest flux density [uJy].",
        ),
    ] = (10.0, 200.0),
    ring: Annotated[
        int,
        typer.Option(
            callback=positive,
            help="Number of galaxies in a ring: they share flux, size and |e|, and their orientations are equally"
            " spaced. With 1 all galaxies are independent.",
        ),
    ] = 1,
    seed: Seed = 1,
    disc: Annotated[bool, typer.Option("--disc", help="Fill a disc instead of a square.")] = False,
    declination_deg: Annotated[
        float | None,
        typer.Option(
            callback=declination,
            help="Declination of the field's centre; with it (ra, dec) are written.",
        ),
    ] = None,
    ra_deg: Annotated[
        float | None,
        typer.Option(callback=finite, help="Right ascension of the field's centre; 0 by default."),
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Draw a population of galaxies with the distributions of Rivi & Miller (2018), section 3.

    Unless --declination-deg is given, positions are written as (l, m), which can be used with any pointing. The true
    ellipticities in the columns e1 and e2 are for simulations; a measurement never uses them.
    """
    import numpy as np

    from uvshear.constants import ARCMIN, MICROJANSKY
    from uvshear.galaxy.flux import PowerLawFlux
    from uvshear.geometry.directions import PhaseCentre
    from uvshear.io.catalogue import catalogue_from_galaxies, write_catalogue
    from uvshear.io.outputs import check_file
    from uvshear.io.tables import check_table_name
    from uvshear.simulation.population import Population, draw_population, expected_number
    from uvshear.simulation.sky_region import DiscField, SquareField

    check_table_name(output)
    check_file(output, overwrite=overwrite)
    reserve(context, [output])
    if (density is None) == (count is None):
        raise InputError("--density or --count: give one of the two")
    if ra_deg is not None and declination_deg is None:
        raise InputError("--ra-deg: --declination-deg is needed as well")
    size = field_arcmin * ARCMIN
    if size >= 1:
        raise InputError(f"--field-arcmin {field_arcmin:g}: a field below 3437 arcmin is needed")
    sky = DiscField(size / 2) if disc else SquareField(size)
    if count is not None:
        number = count
    else:
        assert density is not None
        number = expected_number(sky, density / ARCMIN**2, ring=ring)
    if number == 0:
        raise InputError(
            f"--density {density:g}: the field would hold less than half of a ring of {ring} galaxies, so that none is"
            " drawn; a higher density or a larger field is needed"
        )
    if number % ring:
        raise InputError(f"--count {number}: a multiple of the ring size {ring} is needed")
    population = Population(
        flux=PowerLawFlux(minimum=flux_ujy[0] * MICROJANSKY, maximum=flux_ujy[1] * MICROJANSKY),
        ring=ring,
    )
    galaxies = draw_population(population, sky, number=number, rng=np.random.default_rng(seed))
    centre = None
    if declination_deg is not None:
        centre = PhaseCentre(math.radians(ra_deg or 0.0), math.radians(declination_deg))
    write_catalogue(
        output,
        catalogue_from_galaxies(galaxies, centre),
        provenance(context).metadata(),
        overwrite=overwrite,
    )
    say(f"{output}: {number} galaxies")
