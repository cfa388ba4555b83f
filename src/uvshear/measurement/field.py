"""A catalogue as a measurement sees it."""

from dataclasses import dataclass

import numpy as np

from uvshear.extraction.facets import UvRange
from uvshear.fit.measurement import FitFlag
from uvshear.galaxy import Galaxies, SizePrior
from uvshear.interferometer.extent import Extent
from uvshear.typing import Array, Float, Int, Shaped


@dataclass(frozen=True)
class Field:
    """The sources of a catalogue; those that cannot be measured have a flag other than OK.

    Parameters
    ----------
    l, m
        Positions of the catalogue; facets are centred on them.
    sky
        What the sources look like before anything is fitted.
    size
        Prior of each source's scale length.
    modelled
        Sources that are subtracted, as indices of the catalogue.
    flags
        A :class:`FitFlag` a source.
    uv_range
        Baselines that take part, the longest finite.
    extent
        What the observation holds.
    """

    l: Float[Array, " source"]
    m: Float[Array, " source"]
    sky: Galaxies
    size: SizePrior
    modelled: Int[Array, " member"]
    flags: Shaped[Array, " source"]
    uv_range: UvRange
    extent: Extent

    @property
    def measured(self) -> Int[Array, " member"]:
        """Sources to be fitted, as indices of the catalogue."""
        return np.flatnonzero(self.flags == FitFlag.OK)
