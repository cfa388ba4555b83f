"""Common parts of all pictures: their colours, a new figure, and its file."""

from io import BytesIO
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.figure import Figure

from uvshear.errors import InputError
from uvshear.io.outputs import check_file, new_file

BLUE, ORANGE, GREY = "#0072b2", "#d55e00", "0.45"
"""Blue and vermilion of Okabe and Ito, which colour-blind readers can tell apart; in grey print the markers differ."""


def check_picture(path: Path, *, overwrite: bool = False) -> None:
    """Refuse a file to which no figure can be written, before anything is computed for the figure."""
    check_file(path, overwrite=overwrite)
    _check_format(path)


def _check_format(path: Path) -> None:
    if path.suffix.lower().removeprefix(".") not in FigureCanvasBase.get_supported_filetypes():
        raise InputError(
            f"{path}: the extension is not that of a picture; use .png, .pdf or .svg, for instance"
        )


def save(figure: Figure, path: Path, *, overwrite: bool = False) -> None:
    """Write a figure in the format that the extension of the file names.

    Parameters
    ----------
    figure
        Figure to be written.
    path
        File to write.
    overwrite
        Whether an existing file may be replaced.
    """
    _check_format(path)
    # In memory, because matplotlib's writers hide an error of the disk behind others.
    picture = BytesIO()
    try:
        figure.savefig(picture, dpi=150, format=path.suffix.lower().removeprefix("."))
    except RuntimeError as error:  # such as TeX, which a user's matplotlibrc asks for
        raise InputError(f"{path}: cannot be drawn: {' '.join(str(error).split())}") from error
    with new_file(path, overwrite=overwrite) as temporary:
        temporary.write_bytes(picture.getbuffer())


def new_figure(
    columns: int, width: float, height: float, rows: int = 1
) -> tuple[Figure, list[Axes]]:
    """Make an empty figure with panels side by side, and return the panels of one row after those of another.

    Parameters
    ----------
    columns
        Number of panels in a row.
    width, height
        Size of the figure [inch].
    rows
        Number of rows.
    """
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for ax in axes:
        ax.tick_params(direction="in", top=True, right=True)
    return figure, list(axes)
