"""Galaxies: their parameters, their brightness profiles, and priors on both.

``Galaxies`` is the container that the rest of the package uses. A profile is a subclass of ``Profile`` that defines
``envelope``, as in ``exponential``, and ``registry`` finds it by name. A prior on the ellipticity is a subclass of
``EllipticityPrior`` that defines ``relative_density``. ``flux`` and ``size`` hold the distributions of Rivi & Miller
2018, section 3.
"""

from uvshear.galaxy.ellipticity_prior import (
    DiscEllipticityPrior,
    EllipticityPrior,
    FlatEllipticityPrior,
)
from uvshear.galaxy.exponential import Exponential
from uvshear.galaxy.flux import PowerLawFlux
from uvshear.galaxy.galaxies import Galaxies
from uvshear.galaxy.gaussian import Gaussian
from uvshear.galaxy.profile import Profile
from uvshear.galaxy.registry import PROFILES, profile_named
from uvshear.galaxy.sersic import DiscBulge, Sersic
from uvshear.galaxy.size import CatalogueSize, SizeFluxRelation, SizeModel, SizePrior

__all__ = [
    "PROFILES",
    "CatalogueSize",
    "DiscBulge",
    "DiscEllipticityPrior",
    "EllipticityPrior",
    "Exponential",
    "FlatEllipticityPrior",
    "Galaxies",
    "Gaussian",
    "PowerLawFlux",
    "Profile",
    "Sersic",
    "SizeFluxRelation",
    "SizeModel",
    "SizePrior",
    "profile_named",
]
