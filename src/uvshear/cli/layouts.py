"""``uvshear layouts``: the known arrays, or one with a map."""
# ruff: noqa: PLC0415  (help must not wait for imports)

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.options import Overwrite
from uvshear.cli.outputs import reserve
from uvshear.cli.terminal import say, show_table

if TYPE_CHECKING:
    from uvshear.typing import Array, Float

EPILOG = "Example: uvshear layouts ska-mid-aa4 -o ska.png"

SHORT = "List the known arrays, or show one and draw its map."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("layouts", epilog=EPILOG, short_help=SHORT)(layouts)


def layouts(
    context: typer.Context,
    name: Annotated[
        str | None, typer.Argument(help="A known array, or a file of antenna positions.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Map to draw; NAME-layout.png by default."),
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """List the known arrays, or show one and draw its map."""
    import numpy as np

    from uvshear.interferometer.layout import ArrayLayout, known_layouts, load_layout

    def describe(layout: ArrayLayout) -> tuple[str, ...]:
        shortest, longest = baseline_range(layout.positions)
        diameters = np.unique(layout.diameters[np.isfinite(layout.diameters)])
        return (
            layout.name,
            str(len(layout)),
            f"{shortest:.1f} m",
            f"{longest / 1e3:.3g} km",
            ", ".join(f"{diameter:g}" for diameter in diameters) + " m" if len(diameters) else "?",
        )

    columns = ("array", "antennas", "shortest baseline", "longest baseline", "dishes")
    if name is None:
        rows = [describe(load_layout(known)) for known in known_layouts()]
        show_table(
            "Known arrays (a file of ITRF positions X Y Z [m] can be given as well)", columns, rows
        )
        return
    layout = load_layout(name)
    picture = Path(f"{layout.name}-layout.png") if output is None else output
    from uvshear.plot import check_picture, draw_layout, save

    check_picture(picture, overwrite=overwrite)
    reserve(context, [picture], [Path(name)])
    show_table(layout.name, columns, [describe(layout)])
    say(textwrap.shorten(layout.source, 300, placeholder=" ..."))

    save(draw_layout(layout.positions, layout.name), picture, overwrite=overwrite)
    say(f"map: {picture}")


def baseline_range(positions: "Float[Array, 'antenna 3']") -> tuple[float, float]:
    """Return the lengths of the shortest and of the longest baseline [m], with one row of baselines in memory."""
    import numpy as np

    shortest, longest = np.inf, 0.0
    for k in range(len(positions) - 1):
        lengths = np.linalg.norm(positions[k + 1 :] - positions[k], axis=1)
        shortest, longest = min(shortest, lengths.min()), max(longest, lengths.max())
    return float(shortest), float(longest)
