"""What a galaxy is: its parameters, its profile, and what is known of it before it is measured.

``Galaxies`` is the container that the rest of the package passes round. A profile of your own is
one module here: subclass ``Profile`` and define ``envelope``, as ``exponential`` does; a prior of
the ellipticity likewise: ``EllipticityPrior`` and ``relative_density``. ``flux`` and ``size`` hold
the distributions of Rivi & Miller 2018, section 3.
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
from uvshear.galaxy.sersic import DiscBulge, Sersic
from uvshear.galaxy.size import CatalogueSize, SizeFluxRelation, SizeModel, SizePrior

__all__ = [
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
]
