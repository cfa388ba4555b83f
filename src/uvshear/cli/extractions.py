"""How ``uvshear measure`` tells sources apart, and what it keeps of them, by names."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from enum import StrEnum
from typing import TYPE_CHECKING

from uvshear.cli.names import FacetName
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.extraction import Extraction
    from uvshear.extraction.keep import Statistic
    from uvshear.galaxy import Profile


class ExtractionName(StrEnum):
    """How sources are told apart."""

    CONVERGED = "converged"
    PAPER = "paper"


def extraction_of(
    name: ExtractionName,
    facet: FacetName | None,
    facet_size: float | None,
    rounds: int | None,
    uv_min: float | None = None,
) -> "Extraction":
    """Return the way of telling sources apart; facets are ``facet_size`` scale lengths wide, if given."""
    if name is ExtractionName.CONVERGED:
        if facet is FacetName.CELL_AVERAGE:
            raise InputError(
                "--extraction converged --facet cell-average: its facets are exact;"
                " --extraction paper is needed, or --facet exact"
            )
        if rounds is not None:
            raise InputError(
                f"--extraction converged --rounds {rounds}: it goes on until nothing changes;"
                " --extraction paper is needed, or no --rounds"
            )
        return _converged(facet_size, uv_min)
    return _paper(facet or FacetName.CELL_AVERAGE, facet_size, rounds or 1)


def _converged(facet_size: float | None, uv_min: float | None) -> "Extraction":
    from uvshear.extraction import ConvergedExtraction

    # A shortest baseline that is asked for, 0 too, is taken at its word.
    usual = ConvergedExtraction()
    return ConvergedExtraction(
        scale_lengths=usual.scale_lengths if facet_size is None else facet_size,
        shortest=usual.shortest if uv_min is None else uv_min,
    )


def _paper(facet: FacetName, facet_size: float | None, rounds: int) -> "Extraction":
    from uvshear.extraction import PaperExtraction
    from uvshear.extraction.paper.cell_average import CellAverageFacets, PaperTable, ScaleLengths
    from uvshear.extraction.paper.exact import ExactFacets

    if facet is FacetName.EXACT:
        exact = ExactFacets() if facet_size is None else ExactFacets(facet_size)
        return PaperExtraction(exact, rounds)
    rule = PaperTable() if facet_size is None else ScaleLengths(facet_size)
    return PaperExtraction(CellAverageFacets(rule), rounds)


def statistics_of(
    keep: str | None, extraction: ExtractionName, profile: "Profile"
) -> "tuple[Statistic, ...]":
    """Return the statistics of names joined by commas; likelihoods are of the ``profile``."""
    from uvshear.extraction.keep import LikelihoodStatistic, MomentStatistic
    from uvshear.extraction.metacal import MetacalStatistic

    if keep is None:
        return ()
    if extraction is not ExtractionName.CONVERGED:
        raise InputError(f"--keep {keep}: only --extraction converged keeps statistics")
    known: dict[str, Statistic] = {
        "likelihood": LikelihoodStatistic(profile),
        "moments": MomentStatistic(),
        "metacal": MetacalStatistic(profile),
    }
    for name in keep.split(","):
        if name not in known:
            raise InputError(f"--keep {keep}: '{name}' is not known; {', '.join(known)} are")
    return tuple(one for name, one in known.items() if name in keep.split(","))
