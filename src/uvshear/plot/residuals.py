"""Residuals of ellipticities, measured minus true, in units of their errors."""

import numpy as np
from matplotlib.figure import Figure

from uvshear.constants import MICROJANSKY
from uvshear.plot.figure import BLUE, GREY, ORANGE, new_figure
from uvshear.typing import Array, Float


def draw_residuals(
    true: Array,
    measured: Array,
    error: Array,
    flux: Float[Array, " source"],
    title: str = "Residuals: (measured - true) / error",
) -> Figure:
    """Draw the residuals of e1 and e2 in units of their errors: their distribution, and their values against flux.

    Parameters
    ----------
    true, measured
        Ellipticities e1 + i e2; sources with a NaN are left out.
    error
        Standard deviations of e1 and e2, one row for each source.
    flux
        Flux densities [Jy].
    title
        Title of the picture.
    """
    pulls = np.stack([(measured - true).real, (measured - true).imag], axis=1) / error
    good = np.all(np.isfinite(pulls), axis=1)
    pulls, flux = pulls[good], flux[good]
    figure, (histogram, scatter) = new_figure(2, 10, 4.6)
    reach = float(np.clip(np.max(np.abs(pulls), initial=3), 3, 6))
    edges = np.linspace(-reach, reach, 25)
    bins = (edges[1:] + edges[:-1]) / 2
    names = ("$e_1$", "$e_2$")
    for index, (colour, style) in enumerate(((BLUE, "-"), (ORANGE, "--"))):
        values = np.clip(pulls[:, index], -reach, reach)
        width = float(np.std(pulls[:, index])) if len(pulls) else float("nan")
        label = f"{names[index]}, width {width:.2f}"
        histogram.hist(
            values, edges.tolist(), histtype="step", color=colour, ls=style, lw=1.6, label=label
        )
        scatter.plot(
            flux / MICROJANSKY,
            values,
            "os"[index],
            ms=3.5,
            color=colour,
            alpha=0.7,
            mew=0,
            label=names[index],
        )
    normal = np.exp(-(bins**2) / 2) / np.sqrt(2 * np.pi) * len(pulls) * (edges[1] - edges[0])
    histogram.plot(bins, normal, color=GREY, lw=1.2, label="unit normal")
    histogram.set(xlabel="(measured - true) / error", ylabel="galaxies")
    histogram.set_ylim(top=1.35 * max(histogram.get_ylim()[1], 1))
    histogram.legend(frameon=False, loc="upper left", fontsize="small")
    scatter.axhline(0, color=GREY, lw=0.8)
    scatter.axhspan(-1, 1, color=GREY, alpha=0.15, lw=0, label=r"$\pm 1\sigma$")
    scatter.set(xscale="log", xlabel=r"flux density [$\mu$Jy]", ylabel="(measured - true) / error")
    scatter.set_ylim(-1.25 * reach, 1.25 * reach)
    scatter.legend(frameon=False, ncols=3, loc="upper right", fontsize="small")
    figure.suptitle(title)
    return figure
