"""``uvshear shear``: the mean shear of a table of shapes."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear import __version__
from uvshear.cli.options import Overwrite, Seed, non_negative
from uvshear.cli.terminal import say

if TYPE_CHECKING:
    from uvshear.shear.mean import ShearEstimate

EPILOG = "Example: uvshear shear SHAPES.fits --snr-min 10 -o SHEAR.json"


class EstimatorName(StrEnum):
    """An estimator of the shear of a table of shapes."""

    MEAN = "mean"
    MOMENTS = "moments"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("shear", epilog=EPILOG)(shear)


def shear(
    shapes: Annotated[Path, typer.Argument(help="Table written by uvshear measure.")],
    estimator: Annotated[EstimatorName, typer.Option(help="How.")] = EstimatorName.MEAN,
    snr_min: Annotated[
        float, typer.Option(callback=non_negative, help="Leave out galaxies of lower SNR.")
    ] = 0.0,
    seed: Seed = 1,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="JSON file to write.")
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Estimate the shear: the weighted mean ellipticity with 1000 bootstraps, or moments with a jackknife."""
    from uvshear.io.outputs import check_file, write_json
    from uvshear.io.shapes import read_shapes
    from uvshear.io.statistics import read_statistics
    from uvshear.measurement.keep import MomentStatistic
    from uvshear.pipeline import estimate_shear, estimate_shear_by_moments

    if output is not None:
        check_file(output, overwrite=overwrite, inputs=(shapes,))
    table = read_shapes(shapes)
    if estimator is EstimatorName.MOMENTS:
        kept = read_statistics(shapes, len(table), MomentStatistic.columns, "moments")
        estimate = estimate_shear_by_moments(table, kept, snr_min=snr_min)
    else:
        estimate = estimate_shear(table, snr_min=snr_min, seed=seed)
    say(describe_shear(estimate))
    if output is not None:
        write_json(output, asdict(estimate) | {"version": __version__}, overwrite=overwrite)


def describe_shear(estimate: "ShearEstimate") -> str:
    """One line for the terminal."""
    return (
        f"g1 = {estimate.g1:+.5f} +- {estimate.g1_err:.5f}, "
        f"g2 = {estimate.g2:+.5f} +- {estimate.g2_err:.5f} "
        f"({estimate.estimator} of {estimate.n} galaxies)"
    )
