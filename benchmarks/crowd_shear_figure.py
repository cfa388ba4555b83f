"""Picture of ``crowd_shear.py``'s table: shear that is found where there is none, against the density.

python benchmarks/crowd_shear_figure.py crowd.ecsv docs/pictures/crowd_shear.png
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
    table = table[(table["flux"] == "all") & (table["shear"] == 0)]
    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    for i, axes in enumerate(figure.subplots(1, 2, sharey=True), start=1):
        for k, (name, (mark, colour)) in enumerate(MARKS.items()):
            one = table[table["estimator"] == name]
            # side by side, or the error bars hide one another
            axes.errorbar(
                np.asarray(one["density"]) * 1.04 ** (k - 1),
                1e3 * one[f"c{i}"],
                1e3 * one[f"c{i}_err"],
                marker=mark,
                color=colour,
                label=name,
                linestyle="",
                capsize=2,
            )
        axes.axhspan(-1e3 * REQUIREMENT, 1e3 * REQUIREMENT, color="0.9", zorder=0)
        axes.axhline(0, color="0.5", linewidth=0.8)
        axes.set_xscale("log")
        axes.set_xticks([1, 2.8, 5, 8], ["1", "2.8", "5", "8"])
        axes.minorticks_off()
        axes.set_xlabel("galaxies per square arcminute")
        axes.set_ylabel(f"$g_{i}$ found where there is none [$10^{{-3}}$]")
        axes.label_outer()
    figure.axes[0].set_ylabel("shear found where there is none [$10^{-3}$]")
    figure.axes[0].set_title("$g_1$")
    figure.axes[1].set_title("$g_2$")
    figure.axes[0].legend(frameon=False)
    figure.savefig(sys.argv[2], dpi=150)


if __name__ == "__main__":
    main()
