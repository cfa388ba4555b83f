"""One table of biases that were found apart, bin by bin: a bin of faint galaxies needs many more than a bright one.

    python benchmarks/joined_bias.py FAINT.json BRIGHT.json

The files are ``uvshear bias``'s, of one estimator and shear. A bin counts by its galaxies' number in the population
(those that were seen, of those that were drawn) and by the response of one of them.
"""

import json
import sys
from pathlib import Path

import numpy as np

OF_A_RUN = {"n", "failed", "bins", "galaxies", "seed", "flux_min_ujy", "flux_max_ujy", "version"}


def main() -> None:
    """Print the bins and all of them together."""
    records = [json.loads(Path(name).read_text(encoding="utf-8")) for name in sys.argv[1:]]
    for name in set(records[0]) - OF_A_RUN - set(records[0]["bins"][0]):
        if any(one.get(name) != records[0][name] for one in records):
            sys.exit(f"the files differ in {name}")
    if "m1" not in records[0]:
        sys.exit("the files are of no shear, which has no m")
    bins = [one | {"galaxies": record["galaxies"]} for record in records for one in record["bins"]]
    names = [one["flux"] for one in bins]
    if len(set(names)) < len(names):
        sys.exit(f"a bin is there twice: {', '.join(names)}")
    for one in bins:
        print(f"{one['flux']:>12}: {line(one, 'm')}; {line(one, 'c')} ({one['n']} galaxies)")
    print(f"{'all':>12}: {line(joined(bins), 'm')}; {line(joined(bins), 'c')}")


def joined(bins: list[dict]) -> dict[str, float]:
    """Give m and c of all bins, with errors."""
    together = {}
    for i in (1, 2):
        weight = np.array([one["n"] / one["galaxies"] * one[f"response{i}"] for one in bins])
        weight /= weight.sum()
        for name in (f"m{i}", f"c{i}"):
            together[name] = weight @ [one[name] for one in bins]
            together[f"{name}_err"] = np.hypot.reduce(weight * [one[f"{name}_err"] for one in bins])
    return together


def line(one: dict, name: str) -> str:
    """Both components."""
    return ", ".join(
        f"{name}{i} {one[f'{name}{i}']:+.5f} +- {one[f'{name}{i}_err']:.5f}" for i in (1, 2)
    )


if __name__ == "__main__":
    main()
