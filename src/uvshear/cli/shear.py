"""``uvshear shear``: the mean shear of a table of shapes."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear import __version__
from uvshear.cli.corrections import ShearRun, refuse_another
from uvshear.cli.names import EstimatorName
from uvshear.cli.options import Overwrite, Seed, non_negative
from uvshear.cli.priors import METAVAR, PAPER, Prior
from uvshear.cli.terminal import progress_bar, say
from uvshear.errors import InputError

if TYPE_CHECKING:
    from astropy.table import Table

    from uvshear.estimators.estimator import BayesianShear, ShearEstimator
    from uvshear.estimators.mean import ShearEstimate
    from uvshear.io.population import PopulationRecord
    from uvshear.typing import Array, Bool

EPILOG = "Example: uvshear shear SHAPES.fits --snr-min 10 -o SHEAR.json"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("shear", epilog=EPILOG)(shear)


def shear(
    shapes: Annotated[Path, typer.Argument(help="Table written by uvshear measure.")],
    estimator: Annotated[EstimatorName, typer.Option(help="How.")] = EstimatorName.MEAN,
    snr_min: Annotated[
        float, typer.Option(callback=non_negative, help="Leave out galaxies of lower SNR.")
    ] = 0.0,
    flux_min_ujy: Annotated[
        float,
        typer.Option(
            callback=non_negative,
            help="Leave out fainter sources of the catalogue: a cut that shear leaves.",
        ),
    ] = 0.0,
    calibration: Annotated[
        Path | None, typer.Option(help="Bias to take out, written by uvshear bias.")
    ] = None,
    prior: Annotated[
        str,
        typer.Option(
            metavar=METAVAR,
            help="Population of bayesian: the paper's, fitted to the sources, or of a JSON file.",
        ),
    ] = PAPER,
    seed: Seed = 1,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="JSON file to write.")
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Estimate the shear: mean ellipticity (errors by 1000 bootstraps), moments or likelihoods (by a jackknife)."""
    from uvshear.constants import MICROJANSKY
    from uvshear.estimators.estimator import BayesianShear, by_flux
    from uvshear.io.calibration import read_calibration
    from uvshear.io.outputs import check_file, write_json
    from uvshear.io.population import population_record
    from uvshear.io.shapes import averages_cells, inside, read_shapes
    from uvshear.pipeline import selected
    from uvshear.progress import Meter

    if output is not None:
        inputs = [shapes, Path(prior), *([] if calibration is None else [calibration])]
        check_file(output, overwrite=overwrite, inputs=inputs)
    if prior != PAPER and estimator is not EstimatorName.BAYESIAN:
        raise InputError(
            f"--prior {prior}: {estimator.value} has no prior; --estimator bayesian has"
        )
    assumed = Prior.from_option(prior)
    flux_min = flux_min_ujy * MICROJANSKY
    table = read_shapes(shapes)
    bias = None
    if calibration is not None:
        bias = read_calibration(calibration)
        own = ShearRun(estimator.value, snr_min, flux_min_ujy, assumed, averages_cells(table))
        refuse_another(calibration, bias, own)
    chosen = selected(table, snr_min=snr_min, flux_min=flux_min)
    method = _method(estimator, shapes, table, seed)
    population: PopulationRecord = {}
    with progress_bar("estimating the shear") as progress:
        if isinstance(method, BayesianShear):
            method = replace(method, population=assumed.population, meter=Meter(progress))
            population = population_record(assumed.population)
            if assumed.is_fitted:
                method, population = _fitted(method, chosen)
        total = method.of(chosen)
        bins = by_flux(method, inside(table, "flux"), chosen) if "flux" in table.colnames else {}
    if assumed.is_fitted:
        say(describe_population(population))
    if bias is not None:
        total, bins = bias.applied(total), bias.applied_by_flux(bins)
    say(describe_shear(total))
    for name, one in bins.items():
        say(f"{name}: {describe_shear(one)}")
    if output is not None:
        record = asdict(total) | {
            "version": __version__,
            "calibration": None if calibration is None else str(calibration),
            **({"prior": assumed.source, "population": population} if population else {}),
            "bins": [{"flux": name, **asdict(one)} for name, one in bins.items()],
        }
        write_json(output, record, overwrite=overwrite)


def _method(name: EstimatorName, shapes: Path, table: "Table", seed: int) -> "ShearEstimator":
    from uvshear.estimators.packing import PACKED
    from uvshear.extraction.keep import MomentStatistic
    from uvshear.extraction.metacal import MetacalStatistic
    from uvshear.io.statistics import read_statistics
    from uvshear.pipeline import bayesian_shear, mean_shear, metacal_shear, moment_shear

    if name is EstimatorName.MOMENTS:
        kept = read_statistics(shapes, table, MomentStatistic.columns, "moments")
        return moment_shear(table, kept)
    if name is EstimatorName.METACAL:
        columns = MetacalStatistic.columns
        return metacal_shear(read_statistics(shapes, table, columns, "metacal"))
    if name is EstimatorName.BAYESIAN:
        return bayesian_shear(read_statistics(shapes, table, PACKED, "likelihood"))
    return mean_shear(table, seed)


def _fitted(
    method: "BayesianShear", chosen: "Bool[Array, ' source']"
) -> tuple["BayesianShear", "PopulationRecord"]:
    """Give the estimator the population that the chosen galaxies have; and what a file says of it."""
    from uvshear.io.population import fitted_record

    found = method.fit_population(chosen)
    return replace(method, population=found.population), fitted_record(found)


def describe_population(record: "PopulationRecord") -> str:
    """One line for the terminal, of what was fitted."""
    parts = [
        f"{part} {name} = {value:.3f} +- {values[f'{name}_err']:.3f}"
        for part, values in record.items()
        for name, value in values.items()
        if f"{name}_err" in values
    ]
    return f"population: {', '.join(parts)}"


def describe_shear(estimate: "ShearEstimate") -> str:
    """One line for the terminal."""
    return (
        f"g1 = {estimate.g1:+.5f} +- {estimate.g1_err:.5f}, "
        f"g2 = {estimate.g2:+.5f} +- {estimate.g2_err:.5f} "
        f"({estimate.estimator} of {estimate.n} galaxies)"
    )
