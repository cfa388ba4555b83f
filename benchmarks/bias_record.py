"""Turn files of ``uvshear bias`` into records that the documentation can quote.

    python benchmarks/bias_record.py BIAS.json bias-moments
    python benchmarks/bias_record.py SEED3.json SEED4.json SEED5.json bias-moments-crowded

The last word is the record's name in ``benchmarks/results``. Figures are m1, m2, c1, c2 with their errors, and the same
for every flux bin after the bin's name (``10-20:m1``). Several files may differ in their seed alone; their figures are
averaged with weights 1/error^2.
"""

import json
import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import typer
from record import RESULTS, write_record

from uvshear.cli.application import app

NAMES = ("m1", "m2", "c1", "c2")
NOT_OF_THE_RESULT = {"output", "overwrite", "threads"}
OF_A_RUN = {"seed", "inputs", "options", "date", "n", "failed", "bins", "response1", "response2"}


def main() -> None:
    """Read, join, write."""
    *paths, name = sys.argv[1:]
    biases = [json.loads(Path(path).read_text(encoding="utf-8")) for path in paths]
    different = differing(biases)
    if different:
        sys.exit(f"the files differ in {', '.join(sorted(different))}")
    first = biases[0]
    setting = {key: first.get(key) for key in ("estimator", "galaxies", "shear", "density")}
    write_record(
        RESULTS / f"{name}.json",
        figures(biases),
        [bias["seed"] for bias in biases],
        title=f"Shear bias: {', '.join(f'{key} {value}' for key, value in setting.items() if value)}.",
        command="; ".join(command_line(bias["options"]) for bias in biases),
    )


def command_line(options: Mapping[str, Any]) -> str:
    """Rebuild the command of a file from its options, those with their default values left out."""
    words = ["uvshear", "bias"]
    for parameter in typer.main.get_command(app).commands["bias"].params:
        value = options.get(parameter.name, parameter.default)
        values = list(value) if isinstance(value, list | tuple) else [value]
        usual = parameter.default
        if values == (list(usual) if isinstance(usual, list | tuple) else [usual]):
            continue
        if parameter.name in NOT_OF_THE_RESULT or value is None:
            continue
        if isinstance(value, bool):
            words.append((parameter.opts if value else parameter.secondary_opts)[0])
        else:
            words += [max(parameter.opts, key=len), *map(str, values)]
    return shlex.join(words)


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
