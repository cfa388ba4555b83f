"""What pictures share: their colours, how a figure begins, and how it is written."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uvshear.errors import InputError
from uvshear.io.outputs import new_file

BLUE, ORANGE, GREY = "#0072b2", "#d55e00", "0.45"
"""Okabe and Ito's blue and vermilion: apart for the colour-blind; in grey print, by marker."""


def save(figure: Figure, path: Path, *, overwrite: bool = False) -> None:
    """Write a figure in the format of the file's extension."""
    known = figure.canvas.get_supported_filetypes()
    if path.suffix.lower().removeprefix(".") not in known:
        raise InputError(f"{path}: is no picture; give an extension such as .png, .pdf or .svg")
    with new_file(path, overwrite=overwrite) as temporary:
        figure.savefig(temporary, dpi=150)


def new_figure(columns: int, width: float, height: float) -> tuple[Figure, list[Axes]]:
    """Begin a figure of some columns; its size in inches."""
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(1, columns, squeeze=False)[0]
    for ax in axes:
        ax.tick_params(direction="in", top=True, right=True)
    return figure, list(axes)
