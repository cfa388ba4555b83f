"""The galaxies behind a lens, before they are lensed."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from uvshear.constants import MICROJANSKY
from uvshear.galaxy import DiscEllipticityPrior, EllipticityPrior, PowerLawFlux, SizeFluxRelation

PopulationRecord: TypeAlias = dict[str, dict[str, float]]
"""Parameters by part and name, as files have them."""

PARAMETERS: Final[Mapping[str, Mapping[str, str]]] = {
    "flux": {"index": "index", "minimum_ujy": "minimum", "maximum_ujy": "maximum"},
    "size": {name: name for name in ("intercept", "slope", "sigma")},
    "ellipticity": {name: name for name in ("c", "e0", "maximum")},
}
"""Names in files of each part's parameters, and the names of its fields."""


@dataclass(frozen=True)
class UnlensedPopulation:
    """Distributions of what is lensed: the flux, the scale length at a flux, the ellipticity."""

    flux: PowerLawFlux = field(default_factory=PowerLawFlux)
    size: SizeFluxRelation = field(default_factory=SizeFluxRelation)
    ellipticity: EllipticityPrior = field(default_factory=DiscEllipticityPrior)

    def record(self) -> PopulationRecord:
        """Return the parameters for a file; ellipticities of another kind than the paper's are left out."""
        record: PopulationRecord = {}
        for part, names in PARAMETERS.items():
            distribution = getattr(self, part)
            if part != "ellipticity" or isinstance(distribution, DiscEllipticityPrior):
                record[part] = {
                    name: getattr(distribution, its) / unit_of(name) for name, its in names.items()
                }
        return record


def unit_of(parameter: str) -> float:
    """Return the unit that a parameter has in files, in SI."""
    return MICROJANSKY if parameter.endswith("_ujy") else 1.0
