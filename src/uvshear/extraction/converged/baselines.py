"""The baselines that are used for the measurement of a field."""

import math
from dataclasses import dataclass, replace

import numpy as np

from uvshear.extraction.converged.plan import SMALL
from uvshear.extraction.converged.reach import NEGLIGIBLE, stretch, used_baselines
from uvshear.extraction.converged.short_baselines import Typical, are_dispensable
from uvshear.extraction.field import Field
from uvshear.galaxy import Exponential, Profile
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
    limit
        Baseline below which the others could be left out by the sizes of the galaxies; 0 unless they are used for what
        they tell of fluxes and sizes.
    """

    shortest: float
    longest: float
    finest: float
    uv_max: Float[Array, " source"]
    limit: float = 0.0

    @classmethod
    def from_field(
        cls,
        field: Field,
        is_galaxy: Bool[Array, " source"],
        shortest: float | None,
        profile: Profile | None = None,
    ) -> "Baselines":
        """Choose the baselines for the modelled sources of a field; their sizes give ``shortest`` unless it is given.

        The short baselines of an array with a dense core give the beam a plateau that is arcminutes wide. It carries
        hardly any information on shapes but couples the fluxes of all sources on it, so that they converge slowly if at
        all. Where an array has only few short baselines, and these determine fluxes and sizes, all baselines are used
        (``short_baselines``).
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
        kept = 0.0
        if shortest is None:
            shortest = 0.0
            if is_galaxy.any():
                large = float(np.percentile((median + 2 * sigma)[is_galaxy], LARGE_PERCENTILE))
                limit = min(LARGE / (2 * math.pi * math.exp(large)), MOST_LEFT_OUT * longest)
                typical, profile = _typical_galaxies(field, is_galaxy), profile or Exponential()
                if are_dispensable(field, typical, profile, limit, longest):
                    shortest = limit
                else:
                    kept = limit
        return cls(
            shortest=max(shortest, field.uv_range.minimum),
            longest=longest,
            finest=max(finest, longest * stretched),
            uv_max=used,
            limit=kept,
        )

    def without_short_ones(self) -> "Baselines":
        """Leave out the baselines below the limit after all."""
        return replace(self, shortest=max(self.shortest, self.limit), limit=0.0)


def _typical_galaxies(field: Field, is_galaxy: Bool[Array, " source"]) -> tuple[Typical, Typical]:
    """Return the median galaxy, and a large one."""
    galaxies = field.modelled[is_galaxy]
    flux = field.sky.flux[galaxies]
    median, sigma = field.size.log_median[galaxies], field.size.sigma[galaxies]
    order = np.argsort(median + 2 * sigma)
    middle = order[len(order) // 2]
    large = order[round(LARGE_PERCENTILE / 100 * (len(order) - 1))]
    return (
        Typical(float(flux[middle]), float(median[middle]), float(sigma[middle])),
        Typical(float(flux[large]), float(median[large] + 2 * sigma[large]), float(sigma[large])),
    )
