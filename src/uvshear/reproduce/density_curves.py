"""Curves of estimates against the density of galaxies, one for each extraction."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from uvshear.plot.curves import Curve
from uvshear.reproduce.crowded_field import WORDS
from uvshear.reproduce.finding import Estimate

Series: TypeAlias = Mapping[str, list[tuple[Estimate, Estimate]]]
"""Estimates of both components at each density, by the name of the extraction."""


def curves_of_density(densities: Sequence[float], series: Series, part: int) -> list[Curve]:
    """Return the curve of one component for each extraction.

    Parameters
    ----------
    densities
        Numbers of galaxies per square arcminute.
    part
        0 or 1 for the first or the second component.
    """
    return [
        Curve(
            WORDS[way],
            list(densities),
            [both[part].value for both in estimates],
            [both[part].error or 0.0 for both in estimates],
        )
        for way, estimates in series.items()
    ]
