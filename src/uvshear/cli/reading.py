"""Options that select the visibilities of a file, for the commands that read them."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.panels import DATA
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.io.reading import Reading

ColumnOption = Annotated[
    str,
    typer.Option(
        "--column",
        rich_help_panel=DATA,
        help="Column of the visibilities; for MSv4, the column before conversion, the variable or the data group.",
    ),
]
SubtractOption = Annotated[
    str | None,
    typer.Option(
        "--subtract",
        rich_help_panel=DATA,
        help="Column of a model that is subtracted from the visibilities, such as MODEL_DATA.",
        show_default=False,
    ),
]
FieldOption = Annotated[
    str | None,
    typer.Option(
        "--field",
        rich_help_panel=DATA,
        help="Name or number of the field; required by all commands but info if the set has several.",
    ),
]
ScansOption = Annotated[
    str | None,
    typer.Option(
        "--scans",
        rich_help_panel=DATA,
        help="Scans to read, such as 3,5-8; all scans unless given.",
    ),
]
ConjugateOption = Annotated[
    bool,
    typer.Option(
        "--conjugate",
        rich_help_panel=DATA,
        help="Reverse the sign of UVW, for a set in which the sky would otherwise appear rotated by 180 degrees"
        " about the phase centre.",
    ),
]


def reading_of(
    column: str,
    field: str | None,
    scans: str | None,
    *,
    conjugates: bool,
    heeds_flags: bool = True,
    subtracted: str | None = None,
) -> "Reading":
    """Return the selection of the options; a number is a field's id if it has one, anything else is its name."""
    from uvshear.io.reading import Reading

    is_number = field is not None and field.isdecimal() and field == str(int(field))
    chosen = int(field) if field is not None and is_number else field
    return Reading(
        column,
        chosen,
        None if scans is None else scans_of(scans),
        heeds_flags=heeds_flags,
        conjugates=conjugates,
        subtracted=subtracted,
    )


def scans_of(text: str) -> tuple[int, ...]:
    """Return the scans of a list of numbers and ranges, which commas separate."""
    scans: list[int] = []
    for part in text.split(","):
        first, dash, last = part.strip().partition("-")
        last = last if dash else first
        if not (first.isdecimal() and last.isdecimal() and int(first) <= int(last)):
            raise InputError(f"--scans {text}: numbers and ranges such as 3,5-8 are needed")
        scans += range(int(first), int(last) + 1)
    return tuple(sorted(set(scans)))
