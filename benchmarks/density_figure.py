"""Slopes and scatter against the density of galaxies, over those of the same galaxies alone: the table of crowded.py.

python benchmarks/density_figure.py density.ecsv docs/pictures/density.png
"""

import sys
from pathlib import Path

import numpy as np
from astropy.table import Table

from uvshear.plot.figure import BLUE, GREY, ORANGE, new_figure, save

STYLES = {"converged": (BLUE, "o", 0.0), "paper": (ORANGE, "s", 0.06)}
LABELS = {"converged": "converged", "paper": "as Rivi & Miller 2018"}


def main() -> None:
    """Draw three panels: slopes of e1 and of e2, and scatter, each over that of the isolated fit."""
    source, picture = map(Path, sys.argv[1:])
    table = Table.read(source)
    figure, axes = new_figure(3, 12.5, 4.2)
    words = ("slope of $e_1$", "slope of $e_2$", "scatter of $e$")
    for ax, name, what in zip(axes, ("slope_e1", "slope_e2", "scatter"), words, strict=True):
        for which, (colour, marker, aside) in STYLES.items():
            for flux, is_filled in (("all", True), ("> 25 uJy", False)):
                rows = unique(table[(table["which"] == which) & (table["flux"] == flux)])
                beside = np.array([alone(table, row)[name] for row in rows])
                error = None if name == "scatter" else np.array(rows[f"{name}_err"]) / beside
                ax.errorbar(
                    np.array(rows["density"]) + aside,
                    np.array(rows[name]) / beside,
                    error,
                    fmt=marker + "-",
                    color=colour,
                    mfc=colour if is_filled else "white",
                    lw=0.8,
                    capsize=2,
                    label=f"{LABELS[which]}, {'all' if is_filled else 'above 25 µJy'}",
                )
        ax.axhline(1, color=GREY, lw=0.8)
        ax.set(
            xlabel="galaxies per square arcminute", ylabel=f"{what} over that alone in the field"
        )
    axes[0].sharey(axes[1])
    axes[0].legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.55, 0.78))
    save(figure, picture, overwrite=True)


def unique(rows: Table) -> Table:
    """Keep the last row of each density, in rising order."""
    rows = rows[np.unique(np.array(rows["density"])[::-1], return_index=True)[1] * -1 - 1]
    return rows[np.argsort(rows["density"])]


def alone(table: Table, row) -> Table:
    """Row of the isolated fits of the same galaxies."""
    same = (table["density"] == row["density"]) & (table["flux"] == row["flux"])
    return table[same & (table["which"] == "alone") & (table["n"] == row["n"])][-1]


if __name__ == "__main__":
    main()
