"""The page that shows the numbers and the pictures of the paper beside those that were found."""

import math
from collections.abc import Sequence
from pathlib import Path

from uvshear.io.outputs import new_file
from uvshear.reproduce.finding import Estimate, Quantity
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.reproduce.reproduced_target import ReproducedTarget

INTRODUCTION = """\
This page compares `uvshear` with Rivi & Miller (2018, MNRAS 476, 2053, "the paper"). It was written by `uvshear
reproduce`. The column "the paper's way" has numbers that were found with the methods of the paper, as far as it
describes them; the column "uvshear" has those of exact facets and of the converged extraction, and numbers of which
there is only one kind. "Pull" is the difference between the paper's way and the paper, divided by the error of this
difference, if at least one of the two has an error. Exact facets are not averages in cells: the model is compared with
all visibilities of a source. The converged extraction subtracts the models of all sources again and again, until they
no longer change. The array is SKA-Mid AA4, whereas the paper has an earlier layout. Tracks are eight hours about
transit unless another one is named. The samples of the paper are 60 s long; here they are, at the scale `paper`, 900 s
long except in `psf-images`, `psf-zenith`, `averaging` and one field of `density`. The noise is scaled such that
signal-to-noise ratios are the same. The zenith is at a declination of −30.7 deg, so that targets at −30 deg are 0.7 deg
from it. Each target draws its own galaxies; the same quantity may therefore differ by its error between targets.
Ellipticities, and m and c with the indices 1 and 2, are in the (l, m) frame of the phase centre, as in the paper. In
the pictures, points of several kinds at the same place are moved slightly apart along the horizontal axis.
"""


def write_page(path: Path, targets: Sequence[ReproducedTarget]) -> None:
    """Write the page, in place of an earlier one.

    Parameters
    ----------
    path
        File to write.
    targets
        What was found, in the order of the sections.
    """
    with new_file(path, overwrite=True) as temporary:
        temporary.write_text(page_of(targets), encoding="utf-8")


def page_of(targets: Sequence[ReproducedTarget]) -> str:
    """Return the page as Markdown."""
    sections = [_section(target) for target in targets]
    return "\n".join(["# The paper reproduced\n", INTRODUCTION, *sections])


def _section(target: ReproducedTarget) -> str:
    published = PublishedFigures.read(target.name)
    lines = [
        f"## {target.title}\n",
        f"The paper, {published.where}: {published.claim}\n",
        f"({', '.join(_origin(target))})\n",
    ]
    if target.quantities:
        lines += [_table(target.quantities), ""]
    lines += [f"![{target.title}]({target.picture})\n", f"*{target.caption}*\n"]
    if target.remarks:
        lines.append(" ".join(target.remarks) + "\n")
    return "\n".join(lines)


def _origin(target: ReproducedTarget) -> list[str]:
    """Say how the numbers of a target were found."""
    known = [
        f"`{target.name}`",
        f"scale `{target.scale}`",
        f"seed {target.seed}",
        f"{_duration(target.seconds)} on one core",
    ]
    return [*known, f"commit {target.commit}"] if target.commit else known


def _table(quantities: Sequence[Quantity]) -> str:
    head = ["| quantity | paper | the paper's way | uvshear | pull |", "|---|---|---|---|---|"]
    rows = [
        f"| {row.name} | {written(row.paper)} | {written(row.as_paper)} | {written(row.own)} |"
        f" {'' if row.pull is None else _signed(f'{row.pull:+.1f}')} |"
        for row in quantities
    ]
    return "\n".join([*head, *rows])


def written(estimate: Estimate | None) -> str:
    """Return a number with its error, of which two digits are shown; a number without an error has four digits."""
    if estimate is None or not math.isfinite(estimate.value):
        return ""
    value, error = estimate.value, estimate.error
    if error is None or not math.isfinite(error) or error <= 0:
        # A final zero is a digit like others, except in a count.
        return _signed(f"{value:.4g}" if value.is_integer() else f"{value:#.4g}")
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{_signed(f'{value:.{decimals}f}')} ± {error:.{decimals}f}"


def _signed(text: str) -> str:
    if "e" in text:
        return text
    # A number that is rounded to zero has no sign.
    return (
        text.replace("-", "−") if any(digit in text for digit in "123456789") else text.lstrip("+-")
    )


def _duration(seconds: float) -> str:
    if seconds < 60:
        return "less than a minute"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"
