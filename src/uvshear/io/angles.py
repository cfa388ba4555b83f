"""Angles that are written out, such as 03h28m12.6s, -27:35:15 or 12 30 45.6."""

import re
from collections.abc import Sequence
from typing import Final

import numpy as np

from uvshear.typing import Array, Float

_MINUSES: Final = str.maketrans({"−": "-", "–": "-", "‐": "-", "—": "-"})  # as typeset

_ANGLE: Final = re.compile(
    r"""\s* (?P<sign>[+-]?) \s* (?P<whole>\d+) \s* (?P<mark>[:hHdD°\s]) \s*
        (?P<minutes>\d+) (?:\.(?P<part>\d*))? \s* (?:[:mM'′\s]|$) \s*
        (?P<seconds>\d+(?:\.\d*)?|\.\d+)? \s* (?:[sS"″]|'')? \s*""",
    re.VERBOSE,
)


def is_sexagesimal(text: str) -> bool:
    """Tell whether a text is an angle with minutes."""
    return _ANGLE.fullmatch(text.translate(_MINUSES)) is not None


def degrees_of(texts: Sequence[str], *, in_hours: bool) -> Float[Array, " source"]:
    """Return angles [deg]; NaN where a text is none.

    Parameters
    ----------
    texts
        Angles in degrees or hours, minutes and seconds. Plain numbers are degrees.
    in_hours
        Whether angles with neither ``h`` nor ``d`` are in hours.
    """
    return np.array([_degrees(text.translate(_MINUSES), in_hours) for text in texts], float)


def _degrees(text: str, in_hours: bool) -> float:
    match = _ANGLE.fullmatch(text)
    if match is None:
        try:
            return float(text)
        except ValueError:
            return np.nan
    minutes = float(f"{match['minutes']}.{match['part'] or 0}")
    seconds = float(match["seconds"] or 0)
    # 60 seconds come from rounding.
    if minutes >= 60 or seconds > 60 or (match["part"] and match["seconds"]):
        return np.nan
    mark = match["mark"].lower()
    size = float(match["whole"]) + minutes / 60 + seconds / 3600
    hours = mark == "h" or (in_hours and mark not in "d°")
    return (-size if match["sign"] == "-" else size) * (15 if hours else 1)
