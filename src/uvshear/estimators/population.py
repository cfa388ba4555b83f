"""The population of galaxies before they are lensed."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from uvshear.constants import MICROJANSKY
from uvshear.galaxy import DiscEllipticityPrior, EllipticityPrior, PowerLawFlux, SizeFluxRelation

PopulationRecord: TypeAlias = dict[str, dict[str, float]]
"""Parameters in the units of files, by part of the population and by name."""

PARAMETERS: Final[Mapping[str, Mapping[str, str]]] = {
    "flux": {"index": "index", "minimum_ujy": "minimum", "maximum_ujy": "maximum"},
    "size": {name: name for name in ("intercept", "slope", "sigma")},
    "ellipticity": {name: name for name in ("c", "e0", "maximum")},
}
"""For each part of a population, the names of its parameters in files and of the fields that hold them."""


@dataclass(frozen=True)
class UnlensedPopulation:
    """Distributions of the properties of unlensed galaxies.

    Parameters
    ----------
    flux
        Distribution of fluxes.
    size
        Distribution of scale lengths at a given flux.
    ellipticity
        Distribution of ellipticities.
    """

    flux: PowerLawFlux = field(default_factory=PowerLawFlux)
    size: SizeFluxRelation = field(default_factory=SizeFluxRelation)
    ellipticity: EllipticityPrior = field(default_factory=DiscEllipticityPrior)

    def record(self) -> PopulationRecord:
        """Return the parameters for a file; a user's own distribution of ellipticities is left out."""
        record: PopulationRecord = {}
        for part, names in PARAMETERS.items():
            distribution = getattr(self, part)
            if part != "ellipticity" or isinstance(distribution, DiscEllipticityPrior):
                record[part] = {
                    name: getattr(distribution, field_name) / unit_of(name)
                    for name, field_name in names.items()
                }
        return record


def unit_of(parameter: str) -> float:
    """Return the unit of a parameter in files, in SI."""
    return MICROJANSKY if parameter.endswith("_ujy") else 1.0
