"""Records of benchmarks: figures together with the command, commit, machine, date and seeds behind them.

A record is a JSON file in ``benchmarks/results``. The documentation quotes figures from these files alone, and
``tests/test_docs.py`` compares (see ``quotes.py``). An error is the figure's name followed by ``_err``.
"""

import json
import os
import platform
import shlex
import subprocess
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

from uvshear import __version__

RESULTS = Path(__file__).parent / "results"


def write_record(
    path: Path,
    figures: Mapping[str, float],
    seeds: Sequence[int],
    *,
    title: str,
    command: str | None = None,
) -> None:
    """Write the figures of a run with its provenance.

    Parameters
    ----------
    figures
        Numbers by name. Names end in the unit where there is one (``wall_min``).
    title
        One sentence that says what was measured.
    command
        Command line of the run; that of this process unless given.
    """
    record = {
        "title": title,
        "command": command or command_line(),
        "commit": commit(),
        "version": __version__,
        "date": datetime.now(UTC).date().isoformat(),
        "machine": machine(),
        "seeds": list(seeds),
        "figures": {name: significant(value) for name, value in figures.items()},
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(record, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"record: {path}")


def command_line() -> str:
    """Return the command of this process as a user types it."""
    script, *arguments = sys.argv
    return shlex.join(["python", os.path.relpath(script), *arguments])


def commit() -> str:
    """Return the commit of the tree, with ``-dirty`` where files other than records differ from it."""
    root = RESULTS.parents[1]

    def git(*arguments: str) -> str:
        return subprocess.run(
            ["git", *arguments], check=True, capture_output=True, text=True, cwd=root
        ).stdout.strip()

    changed = git(
        "status", "--porcelain", "--untracked-files=no", "--", ".", ":!benchmarks/results"
    )
    return git("rev-parse", "--short=10", "HEAD") + ("-dirty" if changed else "")


def machine() -> dict[str, str | int | float]:
    """Describe the processor, the cores that this process may use, and the memory."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        "processor": processor(),
        "cores": len(os.sched_getaffinity(0)),
        "memory_gb": round(memory / 1e9, 1),
        "system": platform.platform(terse=True),
        "python": platform.python_version(),
    }


def processor() -> str:
    """Return the processor's name as Linux gives it, or else as Python does."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def significant(value: float) -> float:
    """Round to six significant digits, which is more than any figure is worth."""
    return value if isinstance(value, int) else float(f"{value:.6g}")
