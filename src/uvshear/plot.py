"""Pictures, and the only importer of matplotlib: functions draw a figure, one saves it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uvshear.constants import ARCSEC, MICROJANSKY, SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.io.outputs import new_file
from uvshear.shear.slope import Slope
from uvshear.typing import Array, Float

BLUE, ORANGE, GREY = "#0072b2", "#d55e00", "0.45"
"""Okabe and Ito's blue and vermilion: apart for the colour-blind; in grey print, by marker."""

MOST_POINTS = 200_000
"""Visibilities drawn of a uv coverage."""


def save(figure: Figure, path: Path, *, overwrite: bool = False) -> None:
    """Write a figure in the format of the file's extension."""
    known = figure.canvas.get_supported_filetypes()
    if path.suffix.lower().removeprefix(".") not in known:
        raise InputError(f"{path}: is no picture; give an extension such as .png, .pdf or .svg")
    with new_file(path, overwrite=overwrite) as temporary:
        figure.savefig(temporary, dpi=150)


def _figure(columns: int, width: float, height: float) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(1, columns, squeeze=False)[0]
    for ax in axes:
        ax.tick_params(direction="in", top=True, right=True)
    return figure, list(axes)


def draw_uv_coverage(
    uvw: Float[Array, "row 3"], frequency: Float[Array, " chan"], title: str = "uv coverage"
) -> Figure:
    """Draw every baseline at the mean frequency with its conjugate, and their number by length."""
    wavelength = SPEED_OF_LIGHT / float(np.mean(frequency))
    uv = uvw[:, :2] / wavelength / 1e3
    length = np.hypot(uv[:, 0], uv[:, 1])
    figure, (plane, counts) = _figure(2, 10, 4.8)
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


def draw_psf(
    image: Float[Array, "l m"], pixel: float, ellipticity: complex, title: str = "PSF"
) -> Figure:
    """Draw the point spread function, North up and East left, and its profiles along l and m.

    Parameters
    ----------
    image
        ``image[i, j]`` at l = (i - size/2) pixel, m = (j - size/2) pixel.
    pixel
        [rad].
    ellipticity
        Quoted in the title.
    """
    size = len(image)
    offset = (np.arange(size) - size // 2) * pixel / ARCSEC
    peak = float(image.max())
    psf = image / peak
    figure, (picture, profile) = _figure(2, 10, 4.8)
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
    picture.set_title(
        f"{title}\n$e$ = {ellipticity.real:+.4f} {ellipticity.imag:+.4f}i", fontsize="medium"
    )
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
    figure, axes = _figure(2, 10, 5.1)
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


def draw_residuals(
    true: Array,
    measured: Array,
    error: Array,
    flux: Float[Array, " source"],
    title: str = "Residuals: (measured - true) / error",
) -> Figure:
    """Draw residuals of e1 and e2 in units of their errors: distributed, and by flux [Jy]."""
    pulls = np.stack([(measured - true).real, (measured - true).imag], axis=1) / error
    good = np.all(np.isfinite(pulls), axis=1)
    pulls, flux = pulls[good], flux[good]
    figure, (histogram, scatter) = _figure(2, 10, 4.6)
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


def draw_shear(
    labels: Sequence[str],
    shear: Sequence[complex],
    error: Sequence[complex],
    true: complex | None = None,
    title: str = "Shear, with 1 sigma errors",
) -> Figure:
    """Draw estimates of (g1, g2), one a label, against the truth.

    Parameters
    ----------
    shear, error
        g1 + i g2, and the standard deviations of both components likewise.
    """
    figure, (ax,) = _figure(1, 5.4, 5.2)
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


def draw_layout(
    positions: Float[Array, "antenna 3"], name: str, core_radius: float | None = None
) -> Figure:
    """Draw a map of an array, the whole and its core, East and North of its median position.

    Parameters
    ----------
    positions
        Geocentric ITRF X, Y, Z [m].
    core_radius
        Of the second panel [m]; the inner half of the antennas unless given.
    """
    east, north = _east_north(positions)
    distance = np.hypot(east, north)
    core = float(np.median(distance)) * 1.3 if core_radius is None else core_radius
    figure, (whole, inner) = _figure(2, 10, 5.5)
    for ax, reach, what in (
        (whole, 1.08 * float(distance.max()), f"{name}: {len(positions)} antennas"),
        (inner, core, f"the inner {np.count_nonzero(distance <= core)}"),
    ):
        unit, label = (1e3, "km") if reach >= 2e3 else (1.0, "m")
        ax.plot(east / unit, north / unit, "o", ms=4, color=BLUE, alpha=0.75, mew=0)
        ax.set(xlim=(-reach / unit, reach / unit), ylim=(-reach / unit, reach / unit))
        ax.set(xlabel=f"East [{label}]", ylabel=f"North [{label}]", title=what, aspect="equal")
    half = core / (1e3 if 1.08 * float(distance.max()) >= 2e3 else 1.0)
    square = np.array([[-half, half, half, -half, -half], [-half, -half, half, half, -half]])
    whole.plot(*square, color=ORANGE, lw=1.2)
    return figure


def _east_north(
    positions: Float[Array, "antenna 3"],
) -> tuple[Float[Array, " antenna"], Float[Array, " antenna"]]:
    """Coordinates in the plane that touches a spherical Earth at the median antenna."""
    middle = np.median(positions, axis=0)
    longitude = np.arctan2(middle[1], middle[0])
    latitude = np.arctan2(middle[2], np.hypot(middle[0], middle[1]))
    offset = positions - middle
    sin_a, cos_a = np.sin(longitude), np.cos(longitude)
    sin_d, cos_d = np.sin(latitude), np.cos(latitude)
    east = offset @ np.array([-sin_a, cos_a, 0.0])
    north = offset @ np.array([-sin_d * cos_a, -sin_d * sin_a, cos_d])
    return east, north
