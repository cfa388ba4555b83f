"""Bins of the catalogue's flux, for which shears and biases are reported beside the total."""

from dataclasses import dataclass

from uvshear.constants import MICROJANSKY
from uvshear.typing import Array, Bool, Float


@dataclass(frozen=True)
class FluxBin:
    """Fluxes from ``low`` to below ``high`` [Jy]."""

    low: float
    high: float

    @property
    def name(self) -> str:
        """Name of the bin in files and on the terminal."""
        return f"{self.low / MICROJANSKY:g}-{self.high / MICROJANSKY:g} uJy"

    def holds(self, flux: Float[Array, " source"]) -> Bool[Array, " source"]:
        """Tell which fluxes [Jy] are inside the bin."""
        return (flux >= self.low) & (flux < self.high)


FLUX_BINS = (
    FluxBin(10 * MICROJANSKY, 20 * MICROJANSKY),
    FluxBin(20 * MICROJANSKY, 50 * MICROJANSKY),
    FluxBin(50 * MICROJANSKY, 200 * MICROJANSKY),
)
