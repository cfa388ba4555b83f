"""Picture of ``leakage.py``'s table, its seeds joined: additive bias against the beam's ellipticity and the size.

python benchmarks/leakage_figure.py joined.ecsv docs/pictures/leakage.png
"""

import sys

import numpy as np
from astropy.table import Table
from matplotlib.figure import Figure

MARKS = {"mean": ("o", "C0"), "moments": ("s", "C1"), "bayesian": ("^", "C2")}
REQUIREMENT = 8.2e-4


def main() -> None:
    """Draw it."""
    table = Table.read(sys.argv[1])
    table = table[table["flux"] == "all"]
    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    away, sized = table["size_arcsec"] == 0, table["size_arcsec"] > 0
    for axes, rows, column in ((left, table[away], "psf_e1"), (right, table[sized], "size_arcsec")):
        for name, (mark, colour) in MARKS.items():
            one = rows[rows["estimator"] == name]
            one.sort(column)
            axes.errorbar(
                one[column],
                np.abs(one["c1"]),
                one["c1_err"],
                marker=mark,
                color=colour,
                label=name,
                capsize=2,
            )
        axes.axhspan(0, REQUIREMENT, color="0.9", zorder=0)
        axes.set_yscale("symlog", linthresh=1e-4)
        axes.set_ylim(0, None)
    left.set_xlabel("$e_1$ of the beam, 0 to 60 deg from zenith")
    right.set_xlabel("scale length [arcsec], 40 deg from zenith")
    left.set_ylabel("$|c_1|$")
    left.legend(frameon=False)
    figure.savefig(sys.argv[2], dpi=150)


if __name__ == "__main__":
    main()
