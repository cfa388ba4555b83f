"""The verdict on a run with a mutated input, from how it ended and from the clean run."""

import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
from astropy.table import Table

NOTE, ERROR = "uvshear: note: ", "uvshear: error: "
NOTHING_MEASURED = "no galaxy was measured"
FAILED_REMARKS = ("could not be checked", "a remark cannot be shown")
"""Notes in place of a remark whose computation failed: the run goes on, but the program has an error."""

TOLERANCE = 1e-3
"""Part of a standard error within which shapes and shears are the same, and relative difference of the errors."""

HANG, SLACK = 10.0, 20.0
"""Times the processor time of the clean run, plus so many seconds, from which on a run is taken to hang. The seconds
are ten times what a command takes to start, which the runs of a worker do once. casacore takes five to fill the 2 GB
that the damaged length of a text asks for."""

QUANTITIES = {
    "e1": "e1_err",
    "e2": "e2_err",
    "e1_err": None,
    "e2_err": None,
    "weight": None,
    "snr": None,
    "scale_length": "scale_length_err",
    "scale_length_err": None,
    "flux_fit": "flux_fit_err",
    "flux_fit_err": None,
    "g1": "g1_err",
    "g2": "g2_err",
    "g1_err": None,
    "g2_err": None,
    "n": None,
}
"""Numbers of a result that are compared, with their standard errors; relative differences where there are none."""


class Verdict(Enum):
    """What became of a mutated input."""

    SAME = "the result is that of the clean input"
    REFUSED = "it was refused in one line"
    FLAGGED = "a source has another flag"
    NOTED = "a note tells about it"
    VALID = "the result has changed, and the input is another valid one"
    SILENT = "the result has changed without a word"
    TRACEBACK = "an error of the program"
    WORDS = "something else than notes and one error is on standard error"
    OUTPUTS = "files are not as they should be"
    DISHONEST = "a source is ok that cannot be"
    CRASH = "the process ended"
    HANG = "it did not end"

    @property
    def is_failure(self) -> bool:
        """Whether no input may have this effect."""
        return self in FAILURES


FAILURES = frozenset(
    {
        Verdict.SILENT,
        Verdict.TRACEBACK,
        Verdict.WORDS,
        Verdict.OUTPUTS,
        Verdict.DISHONEST,
        Verdict.CRASH,
        Verdict.HANG,
    }
)


@dataclass(frozen=True)
class Run:
    """How a command ended.

    Parameters
    ----------
    status
        Exit status; None after an error of the program.
    err
        Standard error, or the traceback.
    result
        The file with its result.
    others
        Names of other files that are new.
    seconds
        Processor time.
    """

    status: int | None
    err: str
    result: Path | None
    others: tuple[str, ...]
    seconds: float

    @property
    def notes(self) -> frozenset[str]:
        """Notes, without the numbers in them: only a fact that is new tells a fault."""
        lines = (line for line in self.err.splitlines() if line.startswith(NOTE))
        return frozenset(re.sub(r"[-+]?\d[\d.e+-]*", "#", line) for line in lines)


def judge(  # noqa: PLR0911 - one return for each verdict
    run: Run, clean: Run, content: Any, is_valid: Callable[[], bool]
) -> tuple[Verdict, str]:
    """Return the verdict on a run, with a line that explains it.

    Parameters
    ----------
    content
        Result of the clean run, from :func:`content_of`.
    is_valid
        Tells whether the input is another valid one.
    """
    lines = run.err.splitlines()
    if run.status is None or any(word in run.err for word in FAILED_REMARKS):
        return Verdict.TRACEBACK, run.err
    errors = [line for line in lines if line.startswith(ERROR)]
    strange = [line for line in lines if not line.startswith((NOTE, ERROR))]
    if strange or len(errors) != (run.status == 2) or run.status not in (0, 2):
        return Verdict.WORDS, f"status {run.status}: {(strange or errors or ['no error'])[0]}"
    if run.others:
        return Verdict.OUTPUTS, f"left {', '.join(run.others)}"
    if run.status == 2:
        if run.result is not None and run.result.exists() and NOTHING_MEASURED not in errors[0]:
            return Verdict.OUTPUTS, f"{run.result.name} was written although: {errors[0]}"
        return Verdict.REFUSED, errors[0]
    if run.seconds > HANG * clean.seconds + SLACK:
        return Verdict.HANG, f"{run.seconds:.1f} s of processor time, not {clean.seconds:.1f} s"
    if run.result is None:
        return Verdict.SAME, ""
    if not run.result.exists():
        return Verdict.OUTPUTS, f"{run.result.name} was not written"
    return _compared(content_of(run.result), content, run, clean, is_valid)


def _compared(
    found: Any, content: Any, run: Run, clean: Run, is_valid: Callable[[], bool]
) -> tuple[Verdict, str]:
    if wrong := dishonest(found):
        return Verdict.DISHONEST, wrong
    difference = difference_of(found, content)
    if difference is None:
        return Verdict.SAME, ""
    if difference.startswith("flag "):
        return Verdict.FLAGGED, difference
    if new := sorted(run.notes - clean.notes):
        return Verdict.NOTED, new[0]
    if is_valid():
        return Verdict.VALID, difference
    return Verdict.SILENT, difference


def content_of(path: Path) -> Any:
    """Return the rows of a table by identifier, or the one row of a JSON file."""
    if path.suffix == ".json":
        return {"shear": json.loads(path.read_text())}
    if path.suffix not in (".fits", ".ecsv"):
        return {}
    table = Table.read(path)
    names = [name for name in (*QUANTITIES, "id", "flag") if name in table.colnames]
    rows = [{name: table[name][row] for name in names} for row in range(len(table))]
    return {_word(row["id"]): row | {"flag": _word(row["flag"])} for row in rows}


def _word(value: object) -> str:
    return (value.decode() if isinstance(value, bytes) else str(value)).strip()


def dishonest(content: Mapping[str, Mapping[str, Any]]) -> str | None:
    """Return which source is ok although its numbers cannot be; None if there is none."""
    for name, row in content.items():
        if row.get("flag", "ok") != "ok":
            if row.get("weight", 0) != 0:
                return f"{name} is {row['flag']} and has a weight"
            continue
        for quantity, error in QUANTITIES.items():
            if quantity in row and not (row[quantity] is not None and math.isfinite(row[quantity])):
                return f"{name}: {quantity} is {row[quantity]}"
            if error in row and not row[error] > 0:
                return f"{name}: {error} is {row[error]}"
    return None


def difference_of(
    found: Mapping[str, Mapping[str, Any]], clean: Mapping[str, Mapping[str, Any]]
) -> str | None:
    """Return the first difference between results in words; one of flags comes first."""
    for name in found.keys() & clean.keys():
        now, then = found[name].get("flag"), clean[name].get("flag")
        if now != then:
            return f"flag of {name}: {now}, not {then}"
    if found.keys() != clean.keys():
        return f"sources {sorted(found)}, not {sorted(clean)}"
    for name in clean:
        for quantity, error in QUANTITIES.items():
            then, now = clean[name].get(quantity), found[name].get(quantity)
            if then is None and now is None:
                continue
            if then is None or now is None:
                return f"{quantity} of {name}: {now}, not {then}"
            if math.isnan(then) and math.isnan(now):
                continue
            scale = abs(then) if error is None else clean[name].get(error, math.inf)
            if not abs(now - then) <= TOLERANCE * max(scale, np.finfo(float).tiny):
                return f"{quantity} of {name}: {now:.6g}, not {then:.6g}"
    return None
