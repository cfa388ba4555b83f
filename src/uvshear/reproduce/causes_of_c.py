"""What may make the additive bias that Rivi & Miller 2018 find at an SNR of 10 or more (Table 2)."""

import math
from collections.abc import Sequence
from dataclasses import replace

from uvshear.reproduce.finding import Estimate, Quantity, signed

TRACK_WORDS = {
    "about": "track about transit",
    "later": "track that begins at transit",
    "earlier": "track that ends at transit",
}
"""Ends of the names of the rows of these parts."""

ONE_REALISATION = "rings of ten with one realisation of the noise"
MEASURED_CUT = "the same, cut by the measured SNR"
"""Ends of the names of the rows of rings."""

PAPER_RINGS = 1000
"""Number of rings of ten galaxies in the paper, about 10⁴ galaxies."""


def causes_of_c(quantities: Sequence[Quantity], rings: int) -> str:
    """Write what four possible causes do to c: facets, one realisation of the noise, a cut by the SNR, and the track.

    Parameters
    ----------
    quantities
        Rows of the table of ``shear-bias``.
    rings
        Number of rings of ten galaxies in it.
    """
    rows = {row.name: row for row in quantities}
    in_print = rows[_name("modulus of c", TRACK_WORDS["about"])].paper
    modulus = {
        track: _both(rows[_name("modulus of c", words)]) for track, words in TRACK_WORDS.items()
    }
    one, cut = (
        [rows[_name(f"c{part}", words)].as_paper for part in (1, 2)]
        for words in (ONE_REALISATION, MEASURED_CUT)
    )
    scatter = _rms_error(one) * math.sqrt(rings / PAPER_RINGS)
    change = [
        signed(after.value - before.value)
        for before, after in zip(one, cut, strict=True)
        if before is not None and after is not None
    ]
    alike = [
        f"the {words}"
        for words in TRACK_WORDS.values()
        if all(_has_the_sign(rows[_name(f"c{part}", words)]) for part in (1, 2))
    ]
    pulls = [
        signed(_pull_with(rows[_name(f"c{part}", TRACK_WORDS["earlier"])], scatter), 1)
        for part in (1, 2)
    ]
    return (
        "Four causes of the paper's c at an SNR of 10 or more are tried. Its facets: with the track about transit the"
        f" modulus of c is {modulus['about']}. One realisation of the noise: by the errors of our {rings} rings, c of"
        f" {PAPER_RINGS} rings as in the paper would scatter by {scatter:.4f}. The paper's errors do not contain this"
        " scatter if its eight shears share the noise, which it does not say. A cut by the measured SNR: it changes c1"
        f" and c2 of these rings by {' and '.join(change)}. The track: the modulus is {modulus['later']} if it begins"
        f" at transit, and {modulus['earlier']} if it ends there; the paper's is {_written(in_print)}. Both c1 and c2"
        f" have the paper's signs with {' and '.join(alike) or 'none of these tracks'}. With the scatter of one"
        " realisation in the paper's errors, those of the track that ends at transit differ from the paper's by"
        f" {' and '.join(pulls)} errors."
    )


def _name(what: str, words: str) -> str:
    """Return the name of a row at the lower cut."""
    return f"{what}, SNR ≥ 10, {words}"


def _both(row: Quantity) -> str:
    return (
        f"{_written(row.as_paper)} with the paper's facets and {_written(row.own)} with exact ones"
    )


def _written(estimate: Estimate | None) -> str:
    return "unknown" if estimate is None else f"{estimate.value:.4f} ± {estimate.error or 0.0:.4f}"


def _has_the_sign(row: Quantity) -> bool:
    """Whether a number in the paper's way has the sign of that in the paper."""
    if row.paper is None or row.as_paper is None:
        return False
    return row.as_paper.value * row.paper.value > 0


def _pull_with(row: Quantity, scatter: float) -> float:
    """Return the pull of a row if the paper's number has this scatter besides its error."""
    if row.paper is None:
        return math.nan
    paper = replace(row.paper, error=math.hypot(row.paper.error or 0.0, scatter))
    pull = replace(row, paper=paper).pull
    return math.nan if pull is None else pull


def _rms_error(estimates: Sequence[Estimate | None]) -> float:
    """Return the rms error of some estimates."""
    errors = [estimate.error for estimate in estimates if estimate is not None and estimate.error]
    return math.sqrt(sum(error**2 for error in errors) / max(len(errors), 1))
