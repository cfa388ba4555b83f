"""How to measure: every alternative is an object."""

import os
from dataclasses import dataclass, field

import numpy as np

from uvshear.errors import InputError
from uvshear.extraction.facets import UvRange
from uvshear.galaxy import (
    DiscEllipticityPrior,
    EllipticityPrior,
    Exponential,
    FlatEllipticityPrior,
    Profile,
    SizeFluxRelation,
    SizeModel,
)
from uvshear.interferometer.attenuation import Attenuation, total_attenuation
from uvshear.interferometer.weighting import Weighting
from uvshear.measurement.converged import ConvergedExtraction
from uvshear.measurement.extraction import Extraction
from uvshear.measurement.keep import Statistic


def default_extraction() -> Extraction:
    """How sources are told apart unless something else is asked for."""
    return ConvergedExtraction()


def half_of_memory() -> float:
    """Half of the machine's memory [bytes]."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2


@dataclass(frozen=True)
class MeasurementOptions:
    """How to measure; every alternative is an object, and may be one of the user's own.

    Parameters
    ----------
    extraction
        How sources are told apart; :func:`default_extraction` unless given.
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
    weightings
        Applied to the natural weights one after the other (``interferometer.weighting``), which costs information.
        Errors of e stay right for every size, those of fluxes do not (``measurement.weighed``). None unless given.
    position_radius
        Radius of the uniform prior on the position [rad]; None stands for one width of the correlation's peak.
    field_radius
        Sources farther from the phase centre are flagged and left alone [rad].
    smears
        Whether sources are modelled as channels and integrations average them, each according to where it is.
    primary_beam
        Of the dishes (``interferometer.primary_beam``); fluxes are then those of the sky. None of them unless given.
    keep
        Statistics of every source that are kept beside its shape.
    threads
        Shapes and likelihoods do not depend on it; moments and metacalibrations that are kept do, by 1e-8 of
        themselves: which source their weights are first made for.
    memory
        That may be taken to keep what would be worked out again [bytes]; half of the machine's unless given.
    """

    extraction: Extraction = field(default_factory=default_extraction)
    profile: Profile = field(default_factory=Exponential)
    size: SizeModel = field(default_factory=SizeFluxRelation)
    ellipticity: EllipticityPrior = field(default_factory=FlatEllipticityPrior)
    population: EllipticityPrior = field(default_factory=DiscEllipticityPrior)
    uv_range: UvRange = field(default_factory=UvRange)
    weightings: tuple[Weighting, ...] = ()
    position_radius: float | None = None
    field_radius: float = np.radians(5.0)
    smears: bool = True
    primary_beam: Attenuation | None = None
    keep: tuple[Statistic, ...] = ()
    threads: int = 1
    memory: float = field(default_factory=half_of_memory)

    def attenuation(self, declination: float) -> Attenuation | None:
        """Return what averaging and primary beams leave of sources, for a field at this declination [rad]."""
        return total_attenuation(declination, self.primary_beam, smears=self.smears)

    def __post_init__(self) -> None:
        if not self.memory > 0:
            raise InputError(f"memory of {self.memory:g} bytes; more than 0 are needed")
        if self.keep and self.weightings:
            raise InputError(
                "what is kept for shears (--keep) takes the noise for that of natural weights;"
                " no other weighting can be had with it"
            )
