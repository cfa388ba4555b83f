"""Reader of the biases that ``uvshear bias`` writes."""

from collections.abc import Mapping
from pathlib import Path

from uvshear.constants import MICROJANSKY
from uvshear.errors import InputError
from uvshear.estimators.correction import Calibration, Component, Pair
from uvshear.io.records import finite, read_record

_AS_MEASURED = {"wraps": "mean", "legacy_shear": False, "position_error_arcsec": 0.0}
"""What a bias has in common with every table of shapes."""


def read_calibration(path: Path) -> Calibration:
    """Read m and c of an estimator."""
    record = read_record(path, "a file written by `uvshear bias`")
    rows = record.get("bins")
    bins = {
        str(one["flux"]): _pair(path, one)
        for one in (rows if isinstance(rows, list) else [])
        if isinstance(one, dict) and "flux" in one
    }
    if (most := record.get("flux_max_ujy")) is not None:
        raise InputError(f"{path}: is of galaxies of no more than {most} uJy; a shear has all")
    flux_min = (finite(record, "flux_min_ujy") or 0.0) * MICROJANSKY
    estimator = str(record.get("estimator", ""))
    for name, usual in _AS_MEASURED.items():
        if (its := record.get(name, usual)) not in (usual, None):
            raise InputError(
                f"{path}: is of {name.replace('_', ' ')} {its}, which no shear of measured shapes has"
            )
    return Calibration(
        _pair(path, record),
        bins,
        estimator,
        _number(path, record, "snr_min"),
        flux_min,
        str(record.get("prior", "paper")),
        averages_cells=record.get("facet") == "cell-average",
        cuts_on_measured=record.get("selection", "measured") == "measured",
    )


def _pair(path: Path, record: Mapping[str, object]) -> Pair:
    first, second = (
        Component(
            *(_number(path, record, name) for name in (f"m{i}", f"m{i}_err", f"c{i}", f"c{i}_err"))
        )
        for i in (1, 2)
    )
    if min(first.m, second.m) <= -1:
        raise InputError(f"{path}: m is -1 or less: such an estimator does not see the shear")
    return first, second


def _number(path: Path, record: Mapping[str, object], name: str) -> float:
    if (value := finite(record, name)) is None:
        raise InputError(f"{path}: has no number '{name}'; `uvshear bias` with a shear writes one")
    return value
