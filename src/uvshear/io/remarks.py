"""What a user should know of a Measurement Set that is measured all the same."""

from pathlib import Path

from uvshear.io.measurement_set import MeasurementSet
from uvshear.io.measurement_set_header import read_header
from uvshear.io.uvw_sign import uvw_sign_agrees


def remarks_on(path: Path, column: str = "DATA", field: int | str | None = None) -> tuple[str, ...]:
    """One line each: samples left out though nobody flagged them, weights from SIGMA, a UVW of the other sign."""
    counts = MeasurementSet(path, column=column, field=field).summary()
    remarks = []
    for number, what in (
        (counts.non_finite, "are NaN or infinite, in data or weight"),
        (counts.non_positive_weights, "have a weight of zero or less"),
    ):
        if number:
            remarks.append(
                f"{path}: {number} of {counts.samples} visibilities {what}, and no flag; left out"
            )
    if read_header(path, column, field).weight_column == "SIGMA":
        remarks.append(f"{path}: no WEIGHT above zero; the weights are 1/SIGMA^2")
    if uvw_sign_agrees(path, column, field) is False:
        remarks.append(
            f"{path}: UVW is X(ANTENNA2) - X(ANTENNA1) by the antennas' positions; used as stored,"
            " which mirrors the sky if the visibilities follow the other sign"
        )
    return tuple(remarks)
