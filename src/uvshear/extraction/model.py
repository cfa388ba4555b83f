"""Assumptions of a measurement about the galaxies, the catalogue and the dishes."""

from dataclasses import dataclass, field

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


@dataclass(frozen=True)
class Model:
    """Assumptions about the galaxies and the dishes; every part may be an object of the user's own.

    Parameters
    ----------
    profile
        Brightness profile of the galaxies.
    size
        Model that gives the prior on the scale length.
    ellipticity
        Prior on the ellipticity for the posterior mean; flat over abs(e) < 0.95 unless given.
    population
        Distribution of intrinsic ellipticities, for the weights of the shapes.
    position_radius
        Radius of the uniform prior on the position [rad]; None stands for the width (as
        a Gaussian sigma) of the peak that a round galaxy of median size makes in its cross-correlation with the data.
    primary_beam
        Primary beam of the dishes (``interferometer.primary_beam``). If it is given, the catalogue's fluxes are
        intrinsic; with None they are apparent, that is, attenuated by the beam.
    smears
        Whether the models of sources are smeared by the averaging over channels and integrations, each source according
        to its position.
    """

    profile: Profile = field(default_factory=Exponential)
    size: SizeModel = field(default_factory=SizeFluxRelation)
    ellipticity: EllipticityPrior = field(default_factory=FlatEllipticityPrior)
    population: EllipticityPrior = field(default_factory=DiscEllipticityPrior)
    position_radius: float | None = None
    primary_beam: Attenuation | None = None
    smears: bool = True

    def attenuation(self, declination: float) -> Attenuation | None:
        """Return the attenuation of sources by averaging and primary beams, for a field at this declination [rad]."""
        return total_attenuation(declination, self.primary_beam, smears=self.smears)
