"""JSON files of estimated shears."""

from pathlib import Path

from uvshear.constants import MICROJANSKY
from uvshear.estimators.shear_estimate import ShearEstimate
from uvshear.io.outputs import write_json
from uvshear.io.provenance import Provenance
from uvshear.io.records import rounded


def write_shear(
    path: str | Path,
    estimate: ShearEstimate,
    provenance: Provenance | None = None,
    *,
    overwrite: bool = False,
) -> None:
    """Write a shear to a JSON file, in total and by flux, with its cuts and the assumptions of its estimator.

    Raises
    ------
    InputError
        The file exists and is not to be overwritten, or cannot be written.
    """
    made = provenance or Provenance("uvshear.estimate_shear")
    conditions = estimate.conditions
    cuts = None
    if conditions is not None:
        flux_min = rounded(conditions.flux_min / MICROJANSKY)
        cuts = {
            "snr_min": conditions.snr_min,
            "detection_min": conditions.detection_min,
            "flux_min_ujy": flux_min,
        }
    record: dict[str, object] = estimate.numbers() | dict(estimate.assumed) | made.record()
    record |= {
        "cuts": cuts,
        "seed": made.options.get("seed", estimate.seed),
        "calibration": estimate.correction,
        "goodness": None if estimate.goodness is None else estimate.goodness.record(),
        "remarks": list(estimate.remarks),
        "bins": [{"flux": name, **part.numbers()} for name, part in estimate.bins.items()],
    }
    write_json(Path(path), record, overwrite=overwrite)
