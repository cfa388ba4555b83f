"""Turn the slopes and the shear that ``uvshear demo`` found into a record that the documentation can quote.

    uvshear demo uvshear-demo && python benchmarks/demo_record.py uvshear-demo

Figures are the columns of ``slopes.ecsv`` for each component (``slope_e1``, ``slope_unweighted_e1``) and the shear.
"""

import json
import sys
from pathlib import Path

from astropy.table import Table
from record import RESULTS, write_record


def main() -> None:
    """Read, write."""
    directory = Path(sys.argv[1])
    slopes = Table.read(directory / "slopes.ecsv")
    found: dict[str, float] = {}
    for row in slopes:
        for name in slopes.colnames:
            if name != "component":
                base, error = name.removesuffix("_err"), "_err" * name.endswith("_err")
                found[f"{base}_{row['component']}{error}"] = float(row[name])
    shear = json.loads((directory / "shear.json").read_text(encoding="utf-8"))
    found |= {name: shear[name] for name in ("g1", "g1_err", "g2", "g2_err", "n")}
    write_record(
        RESULTS / "demo.json",
        found,
        [1],
        title="The demo: 101 galaxies of 10 to 200 uJy in 6' x 6', 8 h of SKA-Mid AA4, 617 792 rows.",
        command=f"uvshear demo {directory}",
    )


if __name__ == "__main__":
    main()
