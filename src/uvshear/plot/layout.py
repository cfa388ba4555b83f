"""Map of the antennas of an array."""

import numpy as np
from matplotlib.figure import Figure

from uvshear.plot.figure import BLUE, ORANGE, new_figure
from uvshear.typing import Array, Float


def draw_layout(
    positions: Float[Array, "antenna 3"], name: str, core_radius: float | None = None
) -> Figure:
    """Draw the antennas by their distance to the East and North of the median position: the whole array, and its core.

    Parameters
    ----------
    positions
        Geocentric positions X, Y, Z in ITRF [m].
    name
        Name of the array, for the title.
    core_radius
        Half-width of the second panel [m]; unless given, the panel shows the inner half of the antennas.
    """
    east, north = _east_north(positions)
    distance = np.hypot(east, north)
    core = float(np.median(distance)) * 1.3 if core_radius is None else core_radius
    figure, (whole, inner) = new_figure(2, 10, 5.5)
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
    """Coordinates in the plane that is tangent to a spherical Earth at the median antenna."""
    middle = np.median(positions, axis=0)
    longitude = np.arctan2(middle[1], middle[0])
    latitude = np.arctan2(middle[2], np.hypot(middle[0], middle[1]))
    offset = positions - middle
    sin_a, cos_a = np.sin(longitude), np.cos(longitude)
    sin_d, cos_d = np.sin(latitude), np.cos(latitude)
    east = offset @ np.array([-sin_a, cos_a, 0.0])
    north = offset @ np.array([-sin_d * cos_a, -sin_d * sin_a, cos_d])
    return east, north
