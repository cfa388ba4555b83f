"""The sky model of the paper's extraction between two fits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from uvshear.extraction.field import Field
from uvshear.extraction.sky import with_fitted
from uvshear.galaxy import Galaxies
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class PaperSky:
    """All sources of a catalogue with the results of the fits so far.

    Parameters
    ----------
    sky
        The sources; a source without a good fit is round, as at the start.
    fits
        Good fits, by index of the catalogue, from which later fits start.
    power
        Power of the facets that were gathered, by index of the catalogue: 80 kB for a source of median size. Every
        later pass would have to gather it again.
    major_cycles
        Number of major cycles so far.
    """

    sky: Galaxies
    fits: Mapping[int, GalaxyFit] = field(default_factory=dict)
    power: Mapping[int, Float[Array, " cell"]] = field(default_factory=dict)
    major_cycles: int = 0

    def with_facets(self, sources: Sequence[int], facets: Sequence[Facet]) -> Self:
        """Return the sky after a major cycle that has gathered these facets."""
        gathered = {
            source: facet.power.astype(np.float32)
            for source, facet in zip(sources, facets, strict=True)
        }
        return replace(self, power={**self.power, **gathered}, major_cycles=self.major_cycles + 1)

    def with_fits(
        self, among: Field, sources: Sequence[int], fits: Sequence[GalaxyFit | None]
    ) -> Self:
        """Return the sky with good fits; a source without one stays as it is."""
        good = {source: fit for source, fit in zip(sources, fits, strict=True) if fit is not None}
        return replace(self, sky=with_fitted(self.sky, among, good), fits={**self.fits, **good})

    def without_starts(self, sources: Sequence[int]) -> Self:
        """Return the same sky without starting points for these sources, which are then fitted from scratch."""
        fits = {source: fit for source, fit in self.fits.items() if source not in set(sources)}
        return replace(self, fits=fits)
