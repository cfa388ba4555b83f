"""Options for the catalogue that a command reads, and its reading."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.panels import DATA
from uvshear.cli.terminal import notes_of_warnings

if TYPE_CHECKING:
    from uvshear.io.catalogue import Catalogue

FluxUnitOption = Annotated[
    str | None,
    typer.Option(
        "--flux-unit",
        rich_help_panel=DATA,
        help="Unit of the catalogue's fluxes, such as uJy or mJy, for files without units (CSV).",
    ),
]
ColumnMapOption = Annotated[
    str | None,
    typer.Option(
        "--column-map",
        metavar="OURS=THEIRS,...",
        rich_help_panel=DATA,
        help="Columns of the catalogue that have other names, such as ra=RAJ2000,dec=DEJ2000,flux=S_1400.",
        show_default=False,
    ),
]


def catalogue_of_options(
    path: Path,
    flux_unit: str | None,
    column_map: str | None,
    reference_frequency: float | None = None,
) -> "Catalogue":
    """Read a catalogue, and show notes on it."""
    from uvshear.io.catalogue import read_catalogue
    from uvshear.io.column_map import column_map_of

    names = None if column_map is None else column_map_of(column_map)
    with notes_of_warnings():
        return read_catalogue(
            path, flux_unit=flux_unit, reference_frequency=reference_frequency, column_map=names
        )


def file_of(catalogue: Path) -> Path:
    """Return the file of ``FILE.fits[2]``, which no output may replace."""
    from uvshear.io.table_choice import file_and_choice

    return file_and_choice(catalogue)[0]
