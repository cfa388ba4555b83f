"""Turn files of ``uvshear bias`` into records that the documentation can quote.

    python benchmarks/bias_record.py BIAS.json bias-moments
    python benchmarks/bias_record.py SEED3.json SEED4.json SEED5.json bias-moments-crowded

The last word is the record's name in ``benchmarks/results``. Figures are m1, m2, c1, c2 with their errors, and the same
for every flux bin after the bin's name (``10-20:m1``). Several files may differ in their seed alone; their figures are
averaged with weights 1/error^2.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from record import RESULTS, write_record

NAMES = ("m1", "m2", "c1", "c2")
OF_A_RUN = {"seed", "command", "date", "run", "n", "failed", "bins", "response1", "response2"}


def main() -> None:
    """Read, join, write."""
    *paths, name = sys.argv[1:]
    biases = [json.loads(Path(path).read_text(encoding="utf-8")) for path in paths]
    different = differing(biases)
    if different:
        sys.exit(f"the files differ in {', '.join(sorted(different))}")
    first = biases[0]
    setting = {key: first[key] for key in ("estimator", "galaxies", "shear", "density", "profile")}
    write_record(
        RESULTS / f"{name}.json",
        figures(biases),
        [bias["seed"] for bias in biases],
        title=f"Shear bias: {', '.join(f'{key} {value}' for key, value in setting.items() if value)}.",
        command="; ".join(dict.fromkeys(bias["command"] for bias in biases)),
    )


def differing(biases: Sequence[dict]) -> set[str]:
    """Find what the files do not share and should."""
    measured = {key for key in biases[0] if key.removesuffix("_err") in NAMES}
    shared = set(biases[0]) - measured - OF_A_RUN
    return {key for key in shared if any(bias.get(key) != biases[0][key] for bias in biases)}


def figures(biases: Sequence[dict]) -> dict[str, float]:
    """Collect the figures of all galaxies and of each bin of flux."""
    found = joined(biases) | {"galaxies_used": sum(bias["n"] for bias in biases)}
    for k, one in enumerate(biases[0]["bins"]):
        label = one["flux"].split()[0]
        inside = joined([bias["bins"][k] for bias in biases])
        found |= {f"{label}:{name}": value for name, value in inside.items()}
    return found


def joined(parts: Sequence[dict]) -> dict[str, float]:
    """Average each figure with weights 1/error^2."""
    found = {}
    for name in NAMES:
        if name in parts[0]:
            weight = np.array([part[f"{name}_err"] for part in parts]) ** -2.0
            found[name] = float(np.average([part[name] for part in parts], weights=weight))
            found[f"{name}_err"] = float(weight.sum() ** -0.5)
    return found


if __name__ == "__main__":
    main()
