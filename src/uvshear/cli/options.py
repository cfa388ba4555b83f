"""Options that commands share, and the checks of their numbers."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from uvshear.cli.panels import OUTPUT, RESOURCES, GroupedCommand
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.interferometer.uv_range import UvRange
    from uvshear.io.provenance import Provenance

Pair = tuple[float, float]

NO_PART_OF_THE_RESULT = frozenset(
    {"threads", "scheduler", "overwrite", "output", "residual_image", "log", "resume"}
)
"""Options that do not change the result, which provenance leaves out."""

NO_PART_OF_THE_STATE = NO_PART_OF_THE_RESULT | {"memory_gb", "measurement_sets", "catalogue"}
"""Options that may change when a run goes on from a checkpoint, and the inputs, whose content is compared."""


def positive(value: float | None) -> float | None:
    """Check a number above 0."""
    if value is not None and not 0 < value < math.inf:
        raise typer.BadParameter(f"{value:g}; a number above 0 is needed")
    return value


def all_positive(values: list[float] | None) -> list[float] | None:
    """Check numbers above 0."""
    for value in values or ():
        positive(value)
    return values


def non_negative(value: float | None) -> float | None:
    """Check a number of 0 or more."""
    if value is not None and not 0 <= value < math.inf:
        raise typer.BadParameter(f"{value:g}; a number of 0 or more is needed")
    return value


def finite(value: float | None) -> float | None:
    """Check a number that is neither NaN nor infinite."""
    if value is not None and not math.isfinite(value):
        raise typer.BadParameter(f"{value:g}; a finite number is needed")
    return value


def fraction(value: float | None) -> float | None:
    """Check a number above 0, up to 1."""
    if value is not None and not 0 < value <= 1:
        raise typer.BadParameter(f"{value:g}; a number above 0 and at most 1 is needed")
    return value


def declination(value: float | None) -> float | None:
    """Check a declination in degrees."""
    if value is not None and not -90 <= value <= 90:
        raise typer.BadParameter(f"{value:g}; a declination between -90 and 90 degrees is needed")
    return value


def positive_range(value: Pair | None) -> Pair | None:
    """Check 0 < LO < HI."""
    if value is not None and not 0 < value[0] < value[1] < math.inf:
        raise typer.BadParameter(f"{value[0]:g} {value[1]:g} is not a range; 0 < LO < HI is needed")
    return value


def positive_pair(value: Pair | None) -> Pair | None:
    """Check two numbers above 0."""
    if value is not None and not all(0 < number < math.inf for number in value):
        raise typer.BadParameter(f"{value[0]:g} {value[1]:g}: both must be above 0")
    return value


def reduced_shear(value: Pair) -> Pair:
    """Check |g| < 1."""
    if not math.hypot(*value) < 1:
        raise typer.BadParameter(f"{value[0]:g} {value[1]:g}: |g| must be below 1")
    return value


def hour_angle_ranges(values: list[str] | None) -> list[str] | None:
    """Check that each pair joined by :class:`PairsCommand` is a range."""
    for value in values or ():
        start, stop = pair_of_numbers(value)
        if not -math.inf < start < stop < math.inf:
            raise typer.BadParameter(f"{start:g} {stop:g} is not a range; A < B is needed")
    return values


def pair_of_numbers(text: str) -> Pair:
    """Return the two numbers that a comma joins."""
    try:
        first, second = (float(number) for number in text.split(","))
    except ValueError:
        raise typer.BadParameter(
            f"'{text.replace(',', ' ')}': two numbers A B are needed"
        ) from None
    return first, second


class PairsCommand(GroupedCommand):
    """A command whose ``--hour-angles A B`` may be repeated, which typer's options cannot."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Join the two values with a comma before typer sees them."""
        joined: list[str] = []
        rest = list(args)
        while rest:
            word = rest.pop(0)
            if word == "--hour-angles":
                values, rest = rest[:2], rest[2:]
                word = f"{word}={','.join(values)}"
            joined.append(word)
        return super().parse_args(ctx, joined)


Seed = Annotated[
    int,
    typer.Option(
        "--seed", min=0, help="Seed of the random numbers: the same seed gives the same result."
    ),
]
Overwrite = Annotated[
    bool,
    typer.Option("--overwrite", rich_help_panel=OUTPUT, help="Replace outputs that exist."),
]
Threads = Annotated[
    int,
    typer.Option(
        "--threads",
        min=0,
        rich_help_panel=RESOURCES,
        help="Number of cores to use; 0 means all cores.",
    ),
]


def output_option(text: str) -> Any:
    """Return the option of the output of a command, with its help."""
    return typer.Option("-o", "--output", rich_help_panel=OUTPUT, help=text, show_default=False)


def provenance(context: typer.Context, *inputs: Path) -> "Provenance":
    """Return the provenance of an output: the command with all its options, and the files it read."""
    from uvshear.io.provenance import Provenance

    options = {
        name: str(value) if isinstance(value, Path) else value
        for name, value in sorted(context.params.items())
        if name not in NO_PART_OF_THE_RESULT
    }
    return Provenance(context.command_path, tuple(str(path) for path in inputs), options)


def options_of_the_state(context: typer.Context) -> dict[str, object]:
    """Return the options, as they are written on the command line, with which another run can go on."""
    return {
        f"--{name.replace('_', '-')}": "not given" if value is None else value
        for name, value in sorted(context.params.items())
        if name not in NO_PART_OF_THE_STATE
    }


def uv_range_of(uv_min: float, uv_max: float | None) -> "UvRange":
    """Return the uv range of two options, after a check that they fit together."""
    from uvshear.interferometer.uv_range import UvRange

    if uv_max is not None and uv_min >= uv_max:
        raise InputError(f"--uv-min {uv_min:g} --uv-max {uv_max:g}: uv-min < uv-max is needed")
    return UvRange(uv_min, float("inf") if uv_max is None else uv_max)
