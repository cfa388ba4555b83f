"""The seeds of ``leakage.py``'s or ``crowd_shear.py``'s table together, each figure weighed by its error.

python benchmarks/joined_seeds.py leakage.ecsv joined.ecsv
"""

import sys

import numpy as np
from astropy.table import Column, Table

OF_A_RUN = {"seed", "s", "response1", "response2"}
COUNTS = ("n", "failed")


def main() -> None:
    """Join, print, write."""
    table = Table.read(sys.argv[1])
    errors = [name for name in table.colnames if name.endswith("_err")]
    figures = {name.removesuffix("_err") for name in errors}
    about = [name for name in table.colnames if name not in {*figures, *errors, *OF_A_RUN, *COUNTS}]
    rows = []
    for group in table.group_by(about).groups:
        row = dict(zip(about, group[about][0], strict=True))
        row |= {name: group[name].sum() for name in COUNTS}
        for name in sorted(figures):
            row[name], row[f"{name}_err"] = weighed(group[name], group[f"{name}_err"])
        rows.append(row)
    together = Table(rows)
    for name in (*figures, *errors):
        together[name].format = ".5f"
    together.pprint_all()
    together.write(sys.argv[2], overwrite=True)


def weighed(value: Column, error: Column) -> tuple[float, float]:
    """Mean, and its error; NaN of what a run did not have, as m without a shear."""
    if np.ma.is_masked(error):
        return np.nan, np.nan
    weight = np.asarray(error, float) ** -2
    return float(np.average(value, weights=weight)), float(weight.sum() ** -0.5)


if __name__ == "__main__":
    main()
