"""Picture of a field before and after its sources are subtracted."""

import numpy as np
from matplotlib.colors import AsinhNorm
from matplotlib.figure import Figure

from uvshear.constants import ARCMIN, MICROJANSKY
from uvshear.diagnostics.residual_image import DirtyAndResidual, root_mean_square
from uvshear.plot.figure import new_figure

LEAST = 5.0
"""Smallest range of the colours on either side of zero, in standard deviations of the noise."""


def draw_residual_image(
    images: DirtyAndResidual, title: str = "Dirty and residual image"
) -> Figure:
    """Draw the two images with the same colours, North up and East to the left, and quote the rms of each.

    The colours are proportional to the brightness up to the noise, and to its logarithm beyond.
    """
    noise = images.noise / MICROJANSKY
    both = np.stack([images.dirty, images.residual]) / MICROJANSKY
    low, high = min(float(both.min()), -LEAST * noise), max(float(both.max()), LEAST * noise)
    norm = AsinhNorm(noise, low, high)
    half = images.grid.size // 2
    west, east = (
        edge * images.grid.pixel / ARCMIN for edge in (-half - 0.5, images.grid.size - half - 0.5)
    )
    figure, axes = new_figure(2, 11.5, 5.9)
    figure.set_layout_engine("compressed")
    panels = (("Dirty image", images.dirty), ("Residual, all models subtracted", images.residual))
    for ax, (name, image) in zip(axes, panels, strict=True):
        shown = ax.imshow(
            image.T / MICROJANSKY,
            origin="lower",
            extent=(west, east, west, east),
            cmap="cividis",
            norm=norm,
        )
        ax.invert_xaxis()
        ax.set(xlabel="$l$ [arcmin], East to the left", ylabel="$m$ [arcmin], North up")
        rms = root_mean_square(image) / MICROJANSKY
        ax.set_title(f"{name}\nrms {rms:.3g} $\\mu$Jy/beam", fontsize="medium")
    bar = figure.colorbar(shown, ax=axes, label=r"$\mu$Jy/beam (asinh scale)", pad=0.01)
    # Below the noise the scale is linear, and ticks would overlap.
    ticks = [
        tick
        for tick in _ticks(max(high, -low))
        if low <= tick <= high and (tick == 0 or abs(tick) > noise / 2)
    ]
    bar.set_ticks(list(ticks), labels=[f"{tick:g}".replace("-", "−") for tick in ticks])
    bar.minorticks_off()
    shortest, longest = images.uv_range.minimum / 1e3, images.uv_range.maximum / 1e3
    figure.suptitle(
        f"{title}; thermal noise {noise:.3g} $\\mu$Jy/beam,"
        f" natural weights of {shortest:.3g} to {longest:.3g} k$\\lambda$"
    )
    return figure


def _ticks(reach: float) -> list[float]:
    """Zero, and the three largest powers of ten of either sign that a scale holds."""
    top = int(np.floor(np.log10(reach)))
    powers = [float(10.0**power) for power in range(top - 2, top + 1)]
    return [*(-power for power in reversed(powers)), 0.0, *powers]
