"""What a user should know of a Measurement Set that is measured all the same."""

from typing import Final

from uvshear.io.inspection import FieldContent

WEIGHTS_OFF: Final = 0.2
"""Part by which the noise may differ from what the weights say."""


def remarks_on(content: FieldContent) -> tuple[str, ...]:
    """One line each: samples left out though nobody flagged them, weights that are wrong, a UVW of the other sign."""
    path, counts = content.data.path, content.counts
    remarks = [
        f"{path}: {number} of {counts.samples} visibilities {what}, and no flag; left out"
        for number, what in (
            (counts.non_finite, "are NaN or infinite, in data or weight"),
            (counts.non_positive_weights, "have a weight of zero or less"),
        )
        if number
    ]
    if content.data.header.weight_column == "SIGMA":
        remarks.append(f"{path}: no WEIGHT above zero; the weights are 1/SIGMA^2")
    ratio = content.noise_over_weights
    if ratio is not None and abs(ratio - 1) > WEIGHTS_OFF:
        remarks.append(
            f"{path}: the noise is {ratio:.3g} times what the weights say, by the scatter of neighbouring samples;"
            " errors are off by that much unless the weights are mended"
        )
    if content.uvw_agrees is False:
        remarks.append(
            f"{path}: UVW is X(ANTENNA2) - X(ANTENNA1) by the antennas' positions; used as stored,"
            " which mirrors the sky if the visibilities follow the other sign"
        )
    return tuple(remarks)
