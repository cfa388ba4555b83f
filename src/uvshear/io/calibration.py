"""Reader of the biases that ``uvshear bias`` writes."""

import json
import math
from pathlib import Path

from uvshear.errors import InputError
from uvshear.shear.calibration import Calibration, Component


def read_calibration(path: Path) -> Calibration:
    """Read m and c of an estimator."""
    if not path.exists():
        raise InputError(f"{path}: no such file")
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as JSON: {error}") from error
    if not isinstance(record, dict):
        raise InputError(f"{path}: is not a file written by `uvshear bias`")

    def number(name: str) -> float:
        value = record.get(name)
        if not isinstance(value, int | float) or not math.isfinite(value):
            raise InputError(f"{path}: has no number '{name}'; `uvshear bias` writes one")
        return float(value)

    first, second = (
        Component(*(number(name) for name in (f"m{i}", f"m{i}_err", f"c{i}", f"c{i}_err")))
        for i in (1, 2)
    )
    return Calibration(first, second, str(record.get("estimator", "")), number("snr_min"))
