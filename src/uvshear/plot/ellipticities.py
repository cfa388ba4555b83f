"""Measured ellipticities against true ones."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uvshear.diagnostics.slope import Slope, Slopes
from uvshear.plot.figure import BLUE, GREY, ORANGE, new_figure
from uvshear.typing import Array, Float

EXPLANATION = (
    "The dashed line has weights $1/s^2$ ($s$: quoted error), probably the weights of Rivi & Miller 2018."
    " The other weights give\nfaint galaxies more influence, and their slopes are lower: at a low"
    " signal-to-noise ratio the posterior mean with a flat prior is biased towards zero."
)


def draw_ellipticities(
    true: Array,
    measured: Array,
    error: Array,
    slopes: Sequence[Slopes],
    title: str = "Measured against true ellipticity",
) -> Figure:
    """Draw e1 and e2 measured against true, with the errors and the slopes.

    Parameters
    ----------
    true, measured
        Ellipticities e1 + i e2.
    error
        Standard deviations of e1 and e2, one row for each source.
    slopes
        Slopes of e1 and of e2; the line drawn is that of weights 1/s^2.
    """
    figure, axes = new_figure(2, 10, 5.7)
    for index, (ax, fitted) in enumerate(zip(axes, slopes, strict=True)):
        x, y = (true.real, measured.real) if index == 0 else (true.imag, measured.imag)
        _draw_component(ax, x, y, error[:, index], fitted, BLUE if index == 0 else ORANGE)
        ax.set(xlabel=f"true $e_{index + 1}$", ylabel=f"measured $e_{index + 1}$")
    figure.suptitle(f"{title} ({np.count_nonzero(np.isfinite(measured))} galaxies)")
    figure.supxlabel(EXPLANATION, fontsize="small", color=GREY)
    return figure


def _draw_component(
    ax: Axes,
    true: Float[Array, " source"],
    measured: Float[Array, " source"],
    error: Float[Array, " source"],
    slopes: Slopes,
    colour: str,
) -> None:
    reach = 1.08 * float(np.nanmax(np.abs(np.concatenate([true, measured])), initial=0.1))
    line = np.array([-reach, reach])
    ax.plot(line, line, color=GREY, lw=0.9, label="measured = true", zorder=1)
    ax.errorbar(
        true,
        measured,
        error,
        fmt="o" if colour == BLUE else "s",
        ms=3.5,
        color=colour,
        ecolor=colour,
        elinewidth=0.7,
        alpha=0.65,
        zorder=2,
    )
    first = slopes.inverse_variance
    label = (
        f"slope {_quoted(first)}, weights $1/s^2$\n"
        rf"($n_\mathrm{{eff}}$ = {first.effective_number:.0f})"
    )
    ax.plot(line, first.value * line, color="k", lw=1.3, ls="--", label=label, zorder=3)
    for slope, weights in (
        (slopes.population, "weights $1/(s^2 + 0.07)$"),
        (slopes.unweighted, "unweighted"),
    ):
        ax.plot([], [], ls="none", label=f"{_quoted(slope)}, {weights}")
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    ax.legend(frameon=False, loc="upper left", fontsize="small")


def _quoted(slope: Slope) -> str:
    return f"{slope.value:.3f} $\\pm$ {slope.error:.3f}"
