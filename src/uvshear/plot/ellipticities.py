"""Measured ellipticities against true ones."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from uvshear.diagnostics.slope import Slope
from uvshear.plot.figure import BLUE, GREY, ORANGE, new_figure
from uvshear.typing import Array


def draw_ellipticities(
    true: Array,
    measured: Array,
    error: Array,
    slopes: Sequence[Slope],
    title: str = "Measured against true ellipticity",
) -> Figure:
    """Draw e1 and e2 measured against true, with the errors and the slopes.

    Parameters
    ----------
    true, measured
        e1 + i e2.
    error
        Standard deviations of e1 and e2, a row a source.
    slopes
        Of e1 and of e2.
    """
    figure, axes = new_figure(2, 10, 5.1)
    for index, (ax, slope) in enumerate(zip(axes, slopes, strict=True)):
        x, y = (true.real, measured.real) if index == 0 else (true.imag, measured.imag)
        colour, marker = (BLUE, "o") if index == 0 else (ORANGE, "s")
        reach = 1.08 * float(np.nanmax(np.abs(np.concatenate([x, y])), initial=0.1))
        line = np.array([-reach, reach])
        ax.plot(line, line, color=GREY, lw=0.9, label="measured = true", zorder=1)
        ax.errorbar(
            x,
            y,
            error[:, index],
            fmt=marker,
            ms=3.5,
            color=colour,
            ecolor=colour,
            elinewidth=0.7,
            alpha=0.65,
            zorder=2,
        )
        ax.plot(
            line,
            slope.value * line,
            color="k",
            lw=1.3,
            ls="--",
            label=f"slope {slope.value:.3f} $\\pm$ {slope.error:.3f}",
            zorder=3,
        )
        ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        ax.set(xlabel=f"true $e_{index + 1}$", ylabel=f"measured $e_{index + 1}$")
        ax.legend(frameon=False, loc="upper left")
    figure.suptitle(f"{title} ({np.count_nonzero(np.isfinite(measured))} galaxies)")
    return figure
