"""Files of `uvshear bias`, read so that the bias can be removed from a shear."""

from collections.abc import Mapping
from pathlib import Path

from uvshear.constants import MICROJANSKY
from uvshear.errors import InputError
from uvshear.estimators.bias_correction import BiasCorrection, Component, Pair
from uvshear.estimators.shear_estimate import SKY
from uvshear.io.records import finite, read_record

_AS_MEASURED = {"wraps": "mean", "legacy_shear": False, "position_error_arcsec": 0.0}
"""Options of a simulated bias that agree with every table of shapes."""


def read_correction(path: str | Path) -> BiasCorrection:
    """Read m and c of an estimator, in total and by flux.

    Files of version 0.1.0 do not name a frame. Their frame is that of (l, m), so that c2 changes its sign.

    Raises
    ------
    InputError
        The file is damaged, or its bias does not apply to measured shapes.
    """
    path = Path(path)
    record = read_record(path, "a file written by `uvshear bias`")
    frame = record.get("frame")
    if frame not in (None, SKY):
        raise InputError(f"{path}: is in the frame '{frame}'; the frame '{SKY}' is needed")
    if (most := record.get("flux_max_ujy")) is not None:
        raise InputError(
            f"{path}: is the bias of galaxies below {most} uJy, but a shear is that of all galaxies"
        )
    for name, usual in _AS_MEASURED.items():
        if (simulated := record.get(name, usual)) not in (usual, None):
            raise InputError(
                f"{path}: was simulated with {name} = {simulated}, which does not agree with measured shapes"
            )
    sign = 1.0 if frame == SKY else -1.0
    rows = record.get("bins")
    bins = {
        str(row["flux"]): _pair(path, row, sign)
        for row in (rows if isinstance(rows, list) else [])
        if isinstance(row, dict) and "flux" in row
    }
    return BiasCorrection(
        _pair(path, record, sign),
        bins,
        str(record.get("estimator", "")),
        _number(path, record, "snr_min"),
        (finite(record, "flux_min_ujy") or 0.0) * MICROJANSKY,
        str(record.get("prior", "paper")),
        averages_cells=record.get("facet") == "cell-average",
        cuts_on_measured=record.get("selection", "measured") == "measured",
    )


def _pair(path: Path, record: Mapping[str, object], sign: float) -> Pair:
    first, second = (
        Component(
            m=_number(path, record, f"m{i}"),
            m_err=_number(path, record, f"m{i}_err"),
            c=_number(path, record, f"c{i}") * (sign if i == 2 else 1.0),
            c_err=_number(path, record, f"c{i}_err"),
        )
        for i in (1, 2)
    )
    if min(first.m, second.m) <= -1:
        raise InputError(f"{path}: m is -1 or less: such an estimator has no response to a shear")
    return first, second


def _number(path: Path, record: Mapping[str, object], name: str) -> float:
    if (value := finite(record, name)) is None:
        raise InputError(f"{path}: has no number '{name}'; `uvshear bias` with a shear writes one")
    return value
