"""Point spread functions side by side, with the means over rings below them."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter

from uvshear.constants import ARCSEC
from uvshear.imaging.ring_means import ring_means
from uvshear.plot.figure import BLUE, GREY
from uvshear.typing import Array, Float

SOFTENING = 0.02
"""Value over the peak at which the scale of colours turns from linear to logarithmic."""

TICKS = np.array([-0.05, -0.02, 0, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0])


def draw_psf_pair(images: Mapping[str, Float[Array, "l m"]], pixel: float) -> Figure:
    """Draw point spread functions with North up and East to the left, and the mean of each over rings.

    Parameters
    ----------
    images
        Centred images by their titles, all of one size.
    pixel
        Width of a pixel [rad].
    """
    figure = Figure(figsize=(4.9 * len(images) + 0.6, 7.2), layout="constrained")
    axes = figure.subplots(2, len(images), squeeze=False, height_ratios=(3, 1))
    psfs = {title: image / image.max() for title, image in images.items()}
    lowest = min(float(psf.min()) for psf in psfs.values())
    limits = np.arcsinh(np.array([lowest, 1.0]) / SOFTENING)
    for column, (title, psf) in enumerate(psfs.items()):
        above, below = axes[:, column]
        offset = (np.arange(len(psf)) - len(psf) // 2) * pixel / ARCSEC
        edges = (offset[0] - pixel / ARCSEC / 2, offset[-1] + pixel / ARCSEC / 2)
        shown = above.imshow(
            np.arcsinh(psf.T / SOFTENING),
            origin="lower",
            extent=(*edges, *edges),
            cmap="cividis",
            interpolation="nearest",
            vmin=limits[0],
            vmax=limits[1],
        )
        above.invert_xaxis()
        above.set(xlabel="$l$ [arcsec]", ylabel="$m$ [arcsec]", title=f"{title} weighting")
        distance, mean = ring_means(psf, pixel)
        # The central pixel has no place on a logarithmic axis.
        below.plot(distance[1:] / ARCSEC, mean[1:], color=BLUE)
        below.axhline(0, color=GREY, lw=0.8)
        below.set(
            xlabel="distance from the centre [arcsec]",
            ylabel="mean of ring / peak",
            xscale="log",
            xlim=(pixel / ARCSEC, offset[-1]),
            ylim=(-0.1, 1.05),
        )
        below.xaxis.set_major_formatter(FormatStrFormatter("%g"))
        below.tick_params(direction="in", top=True, right=True)
    bar = figure.colorbar(shown, ax=list(axes[0]), label="PSF / peak (asinh scale)")
    ticks = TICKS[lowest <= TICKS]
    bar.set_ticks(list(np.arcsinh(ticks / SOFTENING)), labels=[f"{tick:g}" for tick in ticks])
    return figure
