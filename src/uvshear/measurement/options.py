"""How to measure: every alternative is an object."""

from dataclasses import dataclass, field

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.extraction.exact import ExactFacets
from uvshear.extraction.facets import FacetMethod, UvRange
from uvshear.galaxy import (
    DiscEllipticityPrior,
    EllipticityPrior,
    Exponential,
    FlatEllipticityPrior,
    Profile,
    SizeFluxRelation,
    SizeModel,
)


@dataclass(frozen=True)
class MeasurementOptions:
    """How to measure; every alternative is an object, and may be one of the user's own.

    Parameters
    ----------
    facet
        Way of making facets: ``ExactFacets`` or ``CellAverageFacets``.
    profile
        Brightness profile fitted.
    size
        Source of the prior on the scale length.
    ellipticity
        Prior of the posterior mean; flat over |e| < 0.95 unless given.
    population
        Distribution of intrinsic ellipticities, for the weights.
    uv_range
        Baselines that take part in the shape.
    position_radius
        Radius of the uniform prior on the position [rad]; None stands for one width of the correlation's peak.
    rounds
        Passes over the sources.
    separation
        Sources closer than this are fitted one after the other, the brighter first [rad].
    field_radius
        Sources farther from the phase centre are flagged and left alone [rad].
    threads
        Results do not depend on it.
    """

    facet: FacetMethod = field(default_factory=ExactFacets)
    profile: Profile = field(default_factory=Exponential)
    size: SizeModel = field(default_factory=SizeFluxRelation)
    ellipticity: EllipticityPrior = field(default_factory=FlatEllipticityPrior)
    population: EllipticityPrior = field(default_factory=DiscEllipticityPrior)
    uv_range: UvRange = field(default_factory=UvRange)
    position_radius: float | None = None
    rounds: int = 2
    separation: float = 60 * ARCSEC
    field_radius: float = np.radians(5.0)
    threads: int = 1

    def __post_init__(self) -> None:
        if self.rounds < 1:
            raise InputError(f"{self.rounds} rounds; one or more are needed")
