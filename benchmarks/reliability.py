"""How narrow the posteriors of isolated galaxies are, over what the Fisher matrix and the prior make of them.

Galaxies and options are those of isolated.py, in one pass.

python benchmarks/reliability.py --galaxies 100 --snr 3 10
python benchmarks/reliability.py --galaxies 120 --snr 5 30 --facet paper-table
"""

from collections import Counter

import numpy as np
from isolated import draw, facet_method, measure_one, parse

import uvshear
from uvshear.shapes import shape


def main() -> None:
    """Measure one galaxy after the other, and listen to what was expected of each."""
    arguments = parse()
    galaxies = draw(arguments.galaxies, arguments.seed)
    snr = np.geomspace(*arguments.snr[[0, -1]], arguments.galaxies)
    method = uvshear.Method(extraction=uvshear.PaperExtraction(facet_method(arguments)))
    expected: list[float] = []
    expect = shape._expected_e_sigma

    def listening(*about: object) -> float:
        expected.append(expect(*about))
        return expected[-1]

    shape._expected_e_sigma = listening
    ratios, flags = [], Counter()
    for i in range(arguments.galaxies):
        expected.clear()
        one = galaxies.select(np.array([i]))
        _, _, _, e_sigma, _, flag, _ = measure_one((arguments, method), (one, snr[i], 100 + i))
        flags[flag] += 1
        if flag in {"ok", "unreliable"}:
            ratios.append(e_sigma / expected[-1])
    print(", ".join(f"{number} {flag}" for flag, number in flags.items()))
    print("e_sigma over what is expected: least, 1, 5, 50, 99 per cent, largest")
    print(np.percentile(ratios, [0, 1, 5, 50, 99, 100]).round(3))


if __name__ == "__main__":
    main()
