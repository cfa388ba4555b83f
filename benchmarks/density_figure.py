"""Slopes against the density of galaxies, and how much of the scatter neighbours add: draws the table of crowded.py.

python benchmarks/density_figure.py density.ecsv docs/pictures/density.png
"""

import sys
from pathlib import Path

import numpy as np
from astropy.table import Table

from uvshear.plot.figure import BLUE, GREY, ORANGE, new_figure, save

STYLES = {"alone": (GREY, "D", -0.06), "converged": (BLUE, "o", 0.0), "paper": (ORANGE, "s", 0.06)}
LABELS = {"alone": "alone in the field", "converged": "converged", "paper": "as Rivi & Miller 2018"}


def main() -> None:
    """Draw three panels: slopes of e1 and of e2, and scatter over that of the isolated fit."""
    source, picture = map(Path, sys.argv[1:])
    table = Table.read(source)
    figure, axes = new_figure(3, 12.5, 4.2)
    for ax, name in zip(axes, ("slope_e1", "slope_e2", "scatter"), strict=False):
        for which, (colour, marker, aside) in STYLES.items():
            for flux, filled in (("all", True), ("> 25 uJy", False)):
                rows = table[(table["which"] == which) & (table["flux"] == flux)]
                if name == "scatter" and which == "alone":
                    continue
                rows = unique(rows)
                if len(rows) == 0:
                    continue
                value = np.array(rows[name])
                error = np.array(rows[f"{name}_err"]) if name != "scatter" else None
                if name == "scatter":
                    value = value / np.array([alone(table, row) for row in rows])
                ax.errorbar(
                    np.array(rows["density"]) + aside,
                    value,
                    error,
                    fmt=marker + "-",
                    color=colour,
                    mfc=colour if filled else "white",
                    lw=0.8,
                    capsize=2,
                    label=f"{LABELS[which]}, {'all' if filled else 'above 25 µJy'}",
                )
        ax.set(xlabel="galaxies per square arcminute")
    axes[0].set(ylabel="slope of measured on true $e_1$")
    axes[1].set(ylabel="slope of measured on true $e_2$")
    axes[2].set(ylabel="scatter of $e$ over that alone in the field")
    axes[2].axhline(1, color=GREY, lw=0.8)
    axes[0].legend(frameon=False, fontsize=7.5)
    save(figure, picture, overwrite=True)


def unique(rows: Table) -> Table:
    """Keep the last row of each density, in rising order."""
    rows = rows[np.unique(np.array(rows["density"])[::-1], return_index=True)[1] * -1 - 1]
    return rows[np.argsort(rows["density"])]


def alone(table: Table, row) -> float:
    """Scatter of the isolated fits that stand beside a row."""
    same = (table["density"] == row["density"]) & (table["flux"] == row["flux"])
    beside = table[same & (table["which"] == "alone") & (table["n"] == row["n"])]
    return float(beside["scatter"][-1])


if __name__ == "__main__":
    main()
