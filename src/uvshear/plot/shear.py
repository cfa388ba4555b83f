"""Picture of estimates of the shear."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from uvshear.plot.figure import BLUE, GREY, ORANGE, new_figure


def draw_shear(
    labels: Sequence[str],
    shear: Sequence[complex],
    error: Sequence[complex],
    true: complex | None = None,
    title: str = "Shear, with 1 sigma errors",
) -> Figure:
    """Draw estimates of the shear in the plane of g1 and g2.

    Parameters
    ----------
    labels
        Name of each estimate.
    shear
        Estimates g1 + i g2.
    error
        Standard deviations of g1 and g2, as the real and the imaginary part.
    true
        True shear, if it is known.
    title
        Title of the picture.
    """
    figure, (ax,) = new_figure(1, 5.4, 5.2)
    colours = (BLUE, ORANGE, "#009e73", "#cc79a7")
    for index, (label, g, s) in enumerate(zip(labels, shear, error, strict=True)):
        ax.errorbar(
            [g.real],
            [g.imag],
            xerr=[s.real],
            yerr=[s.imag],
            fmt="osD^"[index % 4],
            ms=6,
            capsize=3,
            color=colours[index % 4],
            label=f"{label}: ({g.real:+.4f}, {g.imag:+.4f}) $\\pm$ ({s.real:.4f}, {s.imag:.4f})",
        )
    ax.axhline(0, color=GREY, lw=0.6)
    ax.axvline(0, color=GREY, lw=0.6)
    points = [abs(g.real) + s.real for g, s in zip(shear, error, strict=True)]
    points += [abs(g.imag) + s.imag for g, s in zip(shear, error, strict=True)]
    if true is not None:
        ax.plot(
            true.real,
            true.imag,
            "k*",
            ms=13,
            mfc="none",
            label=f"true: ({true.real:+.4f}, {true.imag:+.4f})",
        )
        points += [abs(true.real), abs(true.imag)]
    reach = 1.25 * max([point for point in points if np.isfinite(point)], default=0.01)
    reach = max(reach, 1e-3)
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach * 1.35))  # room for the legend
    ax.set(xlabel="$g_1$", ylabel="$g_2$", title=title)
    ax.legend(frameon=False, loc="upper left", fontsize="small")
    return figure
