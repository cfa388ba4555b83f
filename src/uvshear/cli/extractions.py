"""The extraction that the options of ``uvshear measure`` describe."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from uvshear.cli.registered import named_by
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.extraction import Extraction

CONVERGED, PAPER = "converged", "paper"


class FacetName(StrEnum):
    """Method of making facets from visibilities."""

    EXACT = "exact"
    CELL_AVERAGE = "cell-average"


@dataclass(frozen=True)
class ExtractionChoice:
    """Values of the options of an extraction; None where an option is not given."""

    name: str
    facet: FacetName | None = None
    facet_size: float | None = None
    passes: int | None = None
    uv_min: float | None = None

    def extraction(self) -> "Extraction":
        """Return the extraction; facets are ``facet_size`` scale lengths wide, if given."""
        if self.name == CONVERGED:
            return self._converged()
        if self.name == PAPER:
            return self._paper()
        return self._registered()

    def _converged(self) -> "Extraction":
        from uvshear.extraction import ConvergedExtraction

        if self.facet is FacetName.CELL_AVERAGE:
            raise InputError(
                "--extraction converged --facet cell-average: the converged extraction has exact facets;"
                " --extraction paper is needed, or --facet exact"
            )
        if self.passes is not None:
            raise InputError(
                f"--extraction converged --passes {self.passes}: the converged extraction iterates to"
                " convergence; use --extraction paper, or leave out --passes"
            )
        # A shortest baseline that is given replaces the default, even if it is 0.
        usual = ConvergedExtraction()
        return ConvergedExtraction(
            scale_lengths=usual.scale_lengths if self.facet_size is None else self.facet_size,
            shortest=usual.shortest if self.uv_min is None else self.uv_min,
        )

    def _paper(self) -> "Extraction":
        from uvshear.extraction import PaperExtraction
        from uvshear.extraction.paper.cell_average import (
            CellAverageFacets,
            PaperTable,
            ScaleLengths,
        )
        from uvshear.extraction.paper.exact import ExactFacets

        size, passes = self.facet_size, self.passes or 1
        if self.facet is FacetName.EXACT:
            return PaperExtraction(ExactFacets() if size is None else ExactFacets(size), passes)
        rule = PaperTable() if size is None else ScaleLengths(size)
        return PaperExtraction(CellAverageFacets(rule), passes)

    def _registered(self) -> "Extraction":
        from uvshear.extraction.registry import extraction_named

        own = f"the extractions {CONVERGED} and {PAPER}"
        given = {
            "--facet": (self.facet, own),
            "--facet-size": (self.facet_size, own),
            "--passes": (self.passes, f"the extraction {PAPER}"),
        }
        for option, (value, where) in given.items():
            if value is not None:
                raise InputError(f"{option}: applies only to {where}, not to {self.name}")
        with named_by("--extraction", self.name):
            return extraction_named(self.name)
