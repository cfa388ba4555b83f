"""Picture of a point spread function."""

import numpy as np
from matplotlib.figure import Figure

from uvshear.constants import ARCSEC
from uvshear.plot.figure import BLUE, GREY, ORANGE, new_figure
from uvshear.typing import Array, Float


def draw_psf(
    image: Float[Array, "l m"], pixel: float, ellipticity: complex | None, title: str = "PSF"
) -> Figure:
    """Draw a point spread function with North up and East to the left, and its profiles along l and m.

    Parameters
    ----------
    image
        Image with ``image[i, j]`` at l = (i - size/2) pixel, m = (j - size/2) pixel.
    pixel
        Width of a pixel [rad].
    ellipticity
        Ellipticity to be quoted in the title, or None.
    title
        Title of the picture.
    """
    size = len(image)
    offset = (np.arange(size) - size // 2) * pixel / ARCSEC
    peak = float(image.max())
    psf = image / peak
    figure, (picture, profile) = new_figure(2, 10, 4.8)
    edges = (offset[0] - pixel / ARCSEC / 2, offset[-1] + pixel / ARCSEC / 2)
    shown = picture.imshow(
        np.arcsinh(psf.T / 0.02),
        origin="lower",
        extent=(*edges, *edges),
        cmap="cividis",
        interpolation="nearest",
    )
    picture.invert_xaxis()
    picture.set(xlabel="$l$ [arcsec], East to the left", ylabel="$m$ [arcsec], North up")
    if ellipticity is not None:
        title += f"\n$e$ = {ellipticity.real:+.4f} {ellipticity.imag:+.4f}i"
    picture.set_title(title, fontsize="medium")
    bar = figure.colorbar(shown, ax=picture, label="relative to the peak (asinh scale)")
    ticks = np.array([-0.1, -0.02, 0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0])
    ticks = ticks[(ticks >= psf.min()) & (ticks <= 1)]
    bar.set_ticks(list(np.arcsinh(ticks / 0.02)), labels=[f"{tick:g}" for tick in ticks])
    centre = size // 2
    profile.plot(offset, psf[:, centre], color=BLUE, label="along $l$ (East)")
    profile.plot(offset, psf[centre, :], color=ORANGE, ls="--", label="along $m$ (North)")
    profile.axhline(0, color=GREY, lw=0.8)
    profile.set(xlabel="offset [arcsec]", ylabel="PSF / peak", title="Profiles through the peak")
    profile.set_xlim(offset[0], offset[-1])
    profile.legend(frameon=False)
    return figure
