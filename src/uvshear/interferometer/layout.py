"""Positions of the antennas of an array that comes with the package or is described in a file."""

import math
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Float

SHIPPED: Final = MappingProxyType(
    {
        "ska-mid-aa4": ("ska-mid.txt", None),
        "ska-mid-aastar": ("ska-mid.txt", "AAstar"),
        "ska-mid-aa2": ("ska-mid.txt", "AA2"),
        "ska-mid-aa1": ("ska-mid.txt", "AA1"),
        "meerkat": ("ska-mid.txt", "MeerKAT"),
        "vla-a": ("vla-a.txt", None),
        "vla-b": ("vla-b.txt", None),
        "e-merlin": ("e-merlin.txt", None),
    }
)
"""File of each known array, and the stage of construction whose dishes it includes (None: all dishes)."""

STAGE_COLUMN: Final = MappingProxyType({"AA1": 9, "AA2": 10, "AAstar": 11})
"""Column, counted from 0, of a stage's membership flag in ska-mid.txt."""

MEERKAT_DISHES: Final = 64
"""Number of MeerKAT's dishes, M000 to M063, which are the first in ska-mid.txt."""

EARTH_RADIUS_RANGE: Final = (6.33e6, 6.40e6)
"""Distances from the Earth's centre at which an antenna can stand [m]."""

DIAMETER_RANGE: Final = (0.1, 1000.0)
"""Diameters that an antenna can have [m]."""

MOST_ANTENNAS: Final = 10_000
"""Largest number of antennas that is read: their 5e7 baselines take 4 GB in a single integration."""


@dataclass(frozen=True)
class ArrayLayout:
    """Antennas of an interferometer.

    Parameters
    ----------
    name
        Name of the array.
    antenna_names
        Name of each antenna.
    positions
        Geocentric ITRF X, Y, Z [m].
    diameters
        Diameters of the dishes [m]; NaN where the file does not give them.
    source
        Reference for the positions.
    """

    name: str
    antenna_names: tuple[str, ...]
    positions: Float[Array, "antenna 3"]
    diameters: Float[Array, " antenna"]
    source: str

    def __post_init__(self) -> None:
        count = len(self.positions)
        if count < 2:
            raise InputError(
                f"layout {self.name}: {count} antennas; an interferometer has two or more"
            )
        if not len(self.antenna_names) == len(self.diameters) == count:
            raise InputError(
                f"layout {self.name}: every antenna needs one name, one position and one diameter"
            )

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def longitude(self) -> float:
        """East longitude of the mean position [rad]."""
        x, y, _ = self.positions.mean(axis=0)
        return math.atan2(y, x)

    @property
    def latitude(self) -> float:
        """Geodetic latitude (WGS84) of the mean position [rad].

        References
        ----------
        Bowring 1976, Survey Review 23, 323: one step, good to a micrometre on the ground.
        """
        x, y, z = self.positions.mean(axis=0)
        equatorial_radius, flattening = 6_378_137.0, 1 / 298.257223563
        polar_radius = equatorial_radius * (1 - flattening)
        squared_eccentricity = flattening * (2 - flattening)
        p = math.hypot(x, y)
        theta = math.atan2(z * equatorial_radius, p * polar_radius)
        rise = z + squared_eccentricity / (1 - squared_eccentricity) * polar_radius * (
            math.sin(theta) ** 3
        )
        run = p - squared_eccentricity * equatorial_radius * math.cos(theta) ** 3
        return math.atan2(rise, run)


def known_layouts() -> tuple[str, ...]:
    """Names of the arrays that come with the package."""
    return tuple(SHIPPED)


def load_layout(name_or_path: str | Path) -> ArrayLayout:
    """Return a known array, or read a file of the user's.

    The file has one line for each antenna, ``X Y Z [diameter [name ...]]``: geocentric ITRF coordinates [m], dish
    diameter [m] and name. Further columns are ignored, and ``#`` starts a comment.
    """
    name = str(name_or_path).lower()
    if name in SHIPPED:
        return _shipped_layout(name)
    path = Path(name_or_path)
    if not path.is_file():
        raise InputError(
            f"layout {name_or_path}: neither a known array ({', '.join(known_layouts())})"
            " nor a file of antenna positions"
        )
    try:
        # Editors may write a mark of the byte order.
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"layout {path}: cannot be read as text ({error});"
            " lines of X Y Z [diameter [name]] are expected"
        ) from None
    comments, rows = _parse(text, path)
    return _layout(path.stem, " ".join(comments) or str(path), [row for _, row in rows])


def _shipped_layout(name: str) -> ArrayLayout:
    filename, stage = SHIPPED[name]
    resource = files("uvshear.interferometer").joinpath("layouts", filename)
    comments, numbered = _parse(resource.read_text(encoding="utf-8"), Path(filename))
    rows = [row for _, row in numbered]
    if stage == "MeerKAT":
        rows = rows[:MEERKAT_DISHES]
    elif stage is not None:
        rows = [row for row in rows if row[STAGE_COLUMN[stage]] == "1"]
    return _layout(name, " ".join(comments), rows)


def _parse(text: str, path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Comments and the columns of each line with its number, checked."""
    comments: list[str] = []
    rows: list[tuple[int, list[str]]] = []
    first_line_at: dict[tuple[float, ...], int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        content, _, comment = line.partition("#")
        columns = content.split()
        if not columns:
            comments += [comment.strip()] if comment.strip() else []
            continue
        where = f"layout {path}, line {number}"
        position = tuple(_numbers(columns, where)[:3])
        if position in first_line_at:
            raise InputError(
                f"{where}: has the same position as line {first_line_at[position]};"
                " every antenna needs a position of its own"
            )
        first_line_at[position] = number
        rows.append((number, columns))
    if len(rows) < 2:
        raise InputError(
            f"layout {path}: {len(rows)} antennas;"
            " two or more lines of X Y Z [diameter [name]] are needed"
        )
    if len(rows) > MOST_ANTENNAS:
        raise InputError(
            f"layout {path}: {len(rows)} antennas; at most {MOST_ANTENNAS} are expected"
        )
    return comments, rows


def _numbers(columns: list[str], where: str) -> list[float]:
    """Position and, where given, diameter."""
    if len(columns) < 3:
        raise InputError(
            f"{where}: {len(columns)} columns; X Y Z [diameter [name]] in metres are expected"
        )
    try:
        numbers = [float(column) for column in columns[:4]]
    except ValueError:
        wrong = next(column for column in columns[:4] if not _is_number(column))
        raise InputError(
            f"{where}: '{wrong}' is not a number; X Y Z [diameter [name]] in metres are expected"
        ) from None
    radius = math.hypot(*numbers[:3])
    if not EARTH_RADIUS_RANGE[0] < radius < EARTH_RADIUS_RANGE[1]:
        raise InputError(
            f"{where}: the position is {radius:g} m from the Earth's centre; geocentric ITRF X Y Z"
            " in metres, about 6.37e6 from it, are expected (not East, North, Up)"
        )
    low, high = DIAMETER_RANGE
    if len(numbers) == 4 and not low <= numbers[3] <= high:
        raise InputError(
            f"{where}: the diameter is {numbers[3]:g}; {low:g} to {high:g} m are expected"
        )
    return numbers


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _layout(name: str, source: str, rows: list[list[str]]) -> ArrayLayout:
    return ArrayLayout(
        name=name,
        antenna_names=tuple(
            row[4] if len(row) > 4 else f"A{index:03d}" for index, row in enumerate(rows)
        ),
        positions=np.array([[float(column) for column in row[:3]] for row in rows]),
        diameters=np.array([float(row[3]) if len(row) > 3 else math.nan for row in rows]),
        source=source,
    )
