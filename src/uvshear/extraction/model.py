"""What a measurement takes to be true of the galaxies, the catalogue and the dishes."""

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
    """What is believed; every part may be an object of the user's own.

    Parameters
    ----------
    profile
        Brightness profile of the galaxies.
    size
        Source of the prior on the scale length.
    ellipticity
        Prior of the posterior mean; flat over abs(e) < 0.95 unless given.
    population
        Distribution of intrinsic ellipticities, for the weights of the shapes.
    position_radius
        Radius of the uniform prior on the position [rad]; None stands for one width of the correlation's peak.
    primary_beam
        Primary beam of the dishes (``interferometer.primary_beam``), which makes fluxes those of the sky; None takes
        sources as the dishes saw them.
    smears
        Whether sources are modelled as channels and integrations average them, each according to where it is.
    """

    profile: Profile = field(default_factory=Exponential)
    size: SizeModel = field(default_factory=SizeFluxRelation)
    ellipticity: EllipticityPrior = field(default_factory=FlatEllipticityPrior)
    population: EllipticityPrior = field(default_factory=DiscEllipticityPrior)
    position_radius: float | None = None
    primary_beam: Attenuation | None = None
    smears: bool = True

    def attenuation(self, declination: float) -> Attenuation | None:
        """Return what averaging and primary beams leave of sources, for a field at this declination [rad]."""
        return total_attenuation(declination, self.primary_beam, smears=self.smears)
