"""Thousands of mutated inputs, and what became of them: the battery of ``make test-fuzz`` with a record.

    python benchmarks/fuzz.py
    python benchmarks/fuzz.py --seeds 1000 1200 --workers 2

Failures are printed as they are found.
"""

import argparse
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from record import RESULTS, write_record

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.fuzz.battery import Judged, tally, watched
from tests.fuzz.kinds import KINDS, kind_of
from tests.fuzz.oracle import Verdict
from tests.fuzz.test_fuzz import ALL


def main() -> None:
    """Judge the cases of all seeds, and write the record of all of them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", nargs=2, type=int, default=(ALL.start, ALL.stop))
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    seeds = range(*arguments.seeds)
    with tempfile.TemporaryDirectory() as directory, ThreadPoolExecutor(arguments.workers) as pool:
        parts = [
            (Path(directory) / f"worker{number}", seeds[number :: arguments.workers])
            for number in range(arguments.workers)
        ]
        found = [one for part in pool.map(lambda part: judged(*part), parts) for one in part]
    print(tally(found))
    if seeds == ALL:
        title = "Five thousand mutated inputs: how many had which effect"
        write_record(RESULTS / "fuzz.json", figures(found), [seeds.start, seeds.stop], title=title)


def judged(directory: Path, seeds: range) -> list[Judged]:
    """Judge seeds with a worker process of their own."""
    directory.mkdir()
    found = []
    with watched(directory / "clean", directory / "room", KINDS) as worker:
        for number, seed in enumerate(seeds, 1):
            one = worker.judged(kind_of(seed), seed)
            found.append(one)
            if one.verdict.is_failure:
                print(one, flush=True)
            if number % 100 == 0:
                print(f"{directory.name}: {number} of {len(seeds)}", flush=True)
    return found


def figures(found: list[Judged]) -> dict[str, float]:
    """Count the verdicts, in total and of each kind of input."""
    counts = Counter(one.verdict for one in found)
    kinds = Counter(one.kind.replace(" ", "_") for one in found)
    failures = sum(one.verdict.is_failure for one in found)
    return {
        "cases": len(found),
        "failures": failures,
        **{verdict.name.lower(): counts[verdict] for verdict in Verdict},
        **{f"cases_{kind}": count for kind, count in sorted(kinds.items())},
    }


if __name__ == "__main__":
    main()
