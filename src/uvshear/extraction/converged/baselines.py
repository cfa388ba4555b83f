"""The baselines that are used for the measurement of a field."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.extraction.converged.plan import SMALL
from uvshear.extraction.converged.reach import NEGLIGIBLE, stretch, used_baselines
from uvshear.extraction.field import Field
from uvshear.imaging.bands import steepest
from uvshear.typing import Array, Bool, Float

LARGE = 0.37
"""Shortest baseline times 2 pi times a scale length two sigma above the prior's median. There the information on the
ellipticity of a disc grows with the fourth power of the baseline. For SKA-Mid the limit is 3000 wavelengths, and a
third of the visibilities are on shorter baselines."""

LARGE_PERCENTILE = 99.0
"""Percentile of the galaxies' sizes that counts as large."""

MOST_LEFT_OUT = 1 / 50
"""Largest ratio of the shortest baseline to the longest, where an array hardly resolves its galaxies."""


@dataclass(frozen=True)
class Baselines:
    """Lengths of the baselines that are used [wavelengths].

    Parameters
    ----------
    shortest, longest
        Range of all baselines that are used.
    finest
        Longest baseline that the pixels can represent, for the interaction of galaxies that the array does not resolve,
        and for sources far from the phase centre, which see longer baselines than the phase centre does.
    uv_max
        Longest baseline that carries information on each source.
    """

    shortest: float
    longest: float
    finest: float
    uv_max: Float[Array, " source"]

    @classmethod
    def from_field(
        cls, field: Field, is_galaxy: Bool[Array, " source"], shortest: float | None
    ) -> "Baselines":
        """Choose the baselines for the modelled sources of a field; their sizes give ``shortest`` unless it is given.

        The short baselines of an array with a dense core give the beam a plateau that is arcminutes wide. It carries
        hardly any information on shapes but couples the fluxes of all sources on it, so that they converge slowly if at
        all.
        """
        size, members = field.size, field.modelled
        median, sigma = size.log_median[members], size.sigma[members]
        uv_max = np.where(is_galaxy, SMALL / np.exp(median - 2 * sigma), 0.0)
        longest_informative = float(uv_max.max()) if is_galaxy.any() else math.inf
        informative = np.where(is_galaxy, uv_max, longest_informative)
        used = np.minimum(informative, field.uv_range.maximum)
        longest = float(used.max()) * (1 + 1e-9)
        finest = min(float(informative.max()) * (1 + 1e-9), 2 * longest)
        slope = steepest(field.l[members], field.m[members])
        stretched = stretch(used_baselines(field, longest), slope, longest) / NEGLIGIBLE
        if shortest is None:
            shortest = 0.0
            if is_galaxy.any():
                large = float(np.percentile((median + 2 * sigma)[is_galaxy], LARGE_PERCENTILE))
                shortest = min(LARGE / (2 * math.pi * math.exp(large)), MOST_LEFT_OUT * longest)
        return cls(
            shortest=max(shortest, field.uv_range.minimum),
            longest=longest,
            finest=max(finest, longest * stretched),
            uv_max=used,
        )
