"""Panels of points with error bars, measured here or printed in a paper, against one quantity."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

from uvshear.plot.figure import new_figure

COLOURS: Final = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
"""Colours of Okabe and Ito, which colour-blind readers can tell apart."""

MARKERS: Final = "osD^vP*"
"""One more than colours, so that the seventh curve has the colour of the first but not its marker."""

PAPER_COLOUR: Final = "0.25"

APART: Final = 0.015
"""Distance by which points of different curves are moved apart along the axis of x, over the width of the panel."""


@dataclass(frozen=True)
class Curve:
    """Points of one kind.

    Parameters
    ----------
    label
        Entry in the legend.
    x, y
        Positions of the points.
    error, x_error
        Standard errors of y and of x; None where they are negligible.
    is_published
        Whether the points are printed in the paper: these are black crosses.
    is_line
        Whether the points are joined by a line.
    """

    label: str
    x: Sequence[float]
    y: Sequence[float]
    error: Sequence[float] | None = None
    x_error: Sequence[float] | None = None
    is_published: bool = False
    is_line: bool = True


@dataclass(frozen=True)
class CurvePanel:
    """One panel.

    Parameters
    ----------
    x_label, y_label
        Names of the axes, with units.
    curves
        Points to be drawn.
    title
        Title of the panel.
    levels
        Heights of horizontal lines.
    is_log
        Whether the axis of x is logarithmic.
    names
        Names of the places 0, 1, ... along the axis of x, if these are no numbers.
    ticks
        Numbers on the axis of x; chosen by the range unless given.
    is_square
        Whether a unit has the same length along both axes.
    """

    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    title: str = ""
    levels: tuple[float, ...] = ()
    is_log: bool = False
    names: tuple[str, ...] = ()
    ticks: tuple[float, ...] = ()
    is_square: bool = False


def draw_curves(
    panels: Sequence[CurvePanel], rows: int = 1, *, has_common_y: bool = False
) -> Figure:
    """Draw panels side by side.

    Parameters
    ----------
    rows
        Number of rows, which have the same number of panels.
    has_common_y
        Whether all panels have the same range of y.
    """
    columns = len(panels) // rows
    figure, axes = new_figure(columns, 5.0 * columns, 4.2 * rows, rows)
    for ax, panel in zip(axes, panels, strict=True):
        _draw_panel(ax, panel)
    if has_common_y:
        limits = [ax.get_ylim() for ax in axes]
        for ax in axes:
            ax.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))
    return figure


def _draw_panel(ax: Axes, panel: CurvePanel) -> None:
    for level in panel.levels:
        ax.axhline(level, color="0.6", lw=0.8, ls=":")
    number = 0
    move = _Moves(panel)
    for curve in panel.curves:
        if curve.is_published:
            colour, marker, x = PAPER_COLOUR, "x", list(curve.x)
        else:
            colour, marker = COLOURS[number % len(COLOURS)], MARKERS[number % len(MARKERS)]
            x = move.points(number, curve.x)
            number += 1
        ax.errorbar(
            x,
            list(curve.y),
            None if curve.error is None else list(curve.error),
            None if curve.x_error is None else list(curve.x_error),
            fmt=marker,
            ms=7 if curve.is_published else 5,
            mew=1.6 if curve.is_published else 0.8,
            ls=("--" if curve.is_published else "-") if curve.is_line else "none",
            lw=1.0,
            capsize=2.5,
            color=colour,
            label=curve.label,
        )
    ax.set(xlabel=panel.x_label, ylabel=panel.y_label, title=panel.title)
    if panel.is_log:
        ax.set_xscale("log")
        ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        ax.xaxis.set_major_formatter(FormatStrFormatter("%g"))
        ax.xaxis.set_minor_formatter(NullFormatter())
    if panel.ticks:
        ax.set_xticks(panel.ticks, [f"{tick:g}" for tick in panel.ticks])
        ax.minorticks_off()
    if panel.names:
        ax.set_xticks(range(len(panel.names)), panel.names)
        ax.set_xlim(-0.5, len(panel.names) - 0.5)
        ax.minorticks_off()
    if panel.is_square:
        ax.set_aspect("equal", adjustable="datalim")
    if any(curve.label for curve in panel.curves):
        # The points of a square panel lie on a circle, within which there is room.
        if panel.is_square:
            ax.legend(loc="center", fontsize="small")
        else:
            # The ground of the legend hides lines that would strike through its text.
            ax.legend(edgecolor="none", fontsize="small")


class _Moves:
    """Moves the points of the curves of a panel apart, so that their error bars do not cover one another."""

    def __init__(self, panel: CurvePanel) -> None:
        own = [curve for curve in panel.curves if not curve.is_published]
        # Where x has errors too, or differs from curve to curve, the points lie beside one another anyway.
        is_needed = all(curve.x_error is None and curve.x == own[0].x for curve in own)
        self._middle = (len(own) - 1) / 2
        self._is_log = panel.is_log
        x = [
            float(value)
            for curve in panel.curves
            for value in curve.x
            if value > 0 or not panel.is_log
        ]
        ends = (
            (-0.5, len(panel.names) - 0.5)
            if panel.names
            else (min(x, default=0.0), max(x, default=0.0))
        )
        width = math.log(ends[1] / ends[0]) if panel.is_log and x else ends[1] - ends[0]
        self._step = APART * width if is_needed else 0.0

    def points(self, number: int, x: Sequence[float]) -> list[float]:
        """Return the places of the points of the curve of this number."""
        shift = (number - self._middle) * self._step
        return [value * math.exp(shift) if self._is_log else value + shift for value in x]
