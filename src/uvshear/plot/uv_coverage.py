"""Picture of the uv coverage of an observation."""

import numpy as np
from matplotlib.figure import Figure

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.plot.figure import BLUE, ORANGE, new_figure
from uvshear.typing import Array, Float

MOST_POINTS = 200_000
"""Largest number of rows that are drawn; if there are more, a random sample is drawn."""


def draw_uv_coverage(
    uvw: Float[Array, "row 3"], frequency: Float[Array, " chan"], title: str = "uv coverage"
) -> Figure:
    """Draw baselines at the mean frequency with their conjugates, and the distribution of their lengths.

    Parameters
    ----------
    uvw
        Baselines [m].
    frequency
        Channel centres [Hz].
    title
        Title of the picture.
    """
    wavelength = SPEED_OF_LIGHT / float(np.mean(frequency))
    uv = uvw[:, :2] / wavelength / 1e3
    length = np.hypot(uv[:, 0], uv[:, 1])
    figure, (plane, counts) = new_figure(2, 10, 4.8)
    rng = np.random.default_rng(0)
    shown = uv if len(uv) <= MOST_POINTS else uv[rng.choice(len(uv), MOST_POINTS, replace=False)]
    both = np.concatenate([shown, -shown])
    size = float(np.clip(1e5 / max(len(both), 1), 0.25, 4))
    plane.scatter(both[:, 0], both[:, 1], s=size, color=BLUE, linewidths=0, rasterized=True)
    reach = 1.05 * float(length.max(initial=1e-3))
    plane.set(xlim=(reach, -reach), ylim=(-reach, reach), aspect="equal")  # u grows to the East
    plane.set(xlabel=r"$u$ [k$\lambda$]", ylabel=r"$v$ [k$\lambda$]", title=title)
    positive = length[length > 0]
    if len(positive):
        edges = np.geomspace(positive.min(), positive.max() * 1.001, 60)
        counts.hist(positive, edges.tolist(), color=BLUE, alpha=0.85)
        median = float(np.median(positive))
        counts.axvline(median, color=ORANGE, ls="--", label=rf"median {median:.3g} k$\lambda$")
        counts.legend(frameon=False, loc="upper left")
    counts.set(xscale="log", xlabel=r"baseline length [k$\lambda$]", ylabel="rows")
    counts.set(title=f"{len(uv):,} rows at {np.mean(frequency) / 1e6:.4g} MHz")
    return figure
