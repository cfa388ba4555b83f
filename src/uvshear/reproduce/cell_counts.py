"""Numbers of cells of the paper's facets."""

from dataclasses import dataclass

import numpy as np

from uvshear.bias.cell_average import CellCount
from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.extraction.paper.cell_average import PaperTable
from uvshear.galaxy import SizeFluxRelation


@dataclass(frozen=True)
class FixedCount(CellCount):
    """The same number of cells for all galaxies."""

    number: int

    def cells(self, scale_length: float) -> int:
        """Return the number."""
        del scale_length
        return self.number


@dataclass(frozen=True)
class TableCount(CellCount):
    """Numbers of cells by flux, as in Table 1 of Rivi & Miller 2018, and possibly more.

    Parameters
    ----------
    more
        Number of cells that is added to those of the table.
    """

    more: int = 0

    def cells(self, scale_length: float) -> int:
        """Return the number of cells at the flux whose median scale length this is."""
        relation, table = SizeFluxRelation(), PaperTable()
        log_flux = (np.log(scale_length / ARCSEC) - relation.intercept) / relation.slope
        flux = float(np.exp(log_flux)) * MICROJANSKY
        above = [
            size
            for edge, size in zip(table.edges, table.sizes, strict=False)
            if flux >= edge * (1 - 1e-6)
        ]
        return (above[0] if above else table.sizes[-1]) + self.more
