"""What a measurement tells about statistics that were to be kept and are missing."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from typing import TYPE_CHECKING

from uvshear.cli.terminal import say

if TYPE_CHECKING:
    from uvshear.pipeline.measurement import Measurement


def tell_missing_statistics(measurement: "Measurement") -> None:
    """Print how many measured sources have no statistic of an estimator, and why."""
    from uvshear.io.statistics import missing_statistics

    if measurement.statistics is None:
        return
    for estimator in measurement.estimators:
        missing = missing_statistics(measurement.statistics, estimator)
        if missing:
            reasons = ", ".join(f"{count} {flag}" for flag, count in missing.items())
            say(f"no statistics of {estimator} for {sum(missing.values())} sources: {reasons}")
