"""What ``uvshear bias`` can calibrate, which options go together, and the estimators of their names."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import TYPE_CHECKING

from uvshear.cli.names import EstimatorName
from uvshear.cli.priors import PAPER, Prior
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.bias.crowded import FieldEstimator
    from uvshear.bias.estimators import Estimator


class WrappedName(StrEnum):
    """An estimator that metacalibration wraps."""

    MEAN = "mean"
    MOMENTS = "moments"
    BAYESIAN = "bayesian"


class SelectionName(StrEnum):
    """What a cut by the signal-to-noise ratio looks at."""

    CATALOGUE = "catalogue"
    MEASURED = "measured"


def refuse_shear(shear: float, *, is_averaged: bool) -> None:
    """Refuse a shear that is none, and none at all where cells are not those of a turned sky."""
    if shear >= 1:
        raise InputError(f"--shear {shear:g}: |g| below 1 is needed")
    if is_averaged and shear == 0:
        raise InputError("--facet cell-average --shear 0: its cells do not turn; give a shear")


def refuse_estimator(
    estimator: EstimatorName,
    wraps: WrappedName | None,
    prior: str,
    *,
    is_measured: bool,
    is_averaged: bool,
) -> None:
    """Refuse options that the estimator would not heed."""
    is_metacal = estimator is EstimatorName.METACAL
    if wraps is not None and not is_metacal:
        raise InputError(f"--wraps {wraps.value}: is for --estimator metacal")
    if is_metacal and is_measured:
        raise InputError(
            "--estimator metacal --selection measured: the SNR behind its round beam is another than that of"
            " the shapes; --selection catalogue is needed"
        )
    named = (wraps or WrappedName.MEAN).value if is_metacal else estimator.value
    if prior != PAPER and named != EstimatorName.BAYESIAN.value:
        raise InputError(f"--prior {prior}: {named} has no prior; bayesian has")
    if is_averaged and estimator is not EstimatorName.MEAN:
        raise InputError(f"--facet cell-average: is for the paper's mean, not {estimator.value}")


def refuse_in_a_crowd(given: Mapping[str, bool]) -> None:
    """Refuse options that are for galaxies alone in the beam."""
    for name, is_given in given.items():
        if is_given:
            raise InputError(f"{name}: is for galaxies alone in the beam; leave out --density")


def estimator_of(
    name: EstimatorName,
    wraps: WrappedName | None,
    prior: Prior,
    position_sigma: float,
    snr_min: float | None,
) -> "Estimator":
    """Return the estimator of a name; with an ``snr_min``, of galaxies whose fitted SNR is no less."""
    from uvshear.bias.estimators import (
        BayesianEstimator,
        MeanEstimator,
        MetacalEstimator,
        MomentEstimator,
        SelectedEstimator,
    )

    kinds: dict[str, Callable[[], Estimator]] = {
        EstimatorName.MEAN: MeanEstimator,
        EstimatorName.MOMENTS: lambda: MomentEstimator(position_sigma),
        EstimatorName.BAYESIAN: lambda: BayesianEstimator(
            population=prior.population, is_learning=prior.is_fitted
        ),
    }
    is_wrapped = name is EstimatorName.METACAL
    if is_wrapped:
        return MetacalEstimator(kinds[(wraps or WrappedName.MEAN).value]())
    one = kinds[name.value]()
    return one if snr_min is None else SelectedEstimator(one, snr_min)


def field_estimator_of(name: EstimatorName, prior: Prior, seed: int) -> "FieldEstimator":
    """Return the estimator of a name for galaxies of a field."""
    from uvshear.bias.crowded import (
        FieldBayesian,
        FieldMean,
        FieldMetacal,
        FieldMoments,
    )

    kinds: dict[EstimatorName, Callable[[], FieldEstimator]] = {
        EstimatorName.MEAN: FieldMean,
        EstimatorName.MOMENTS: FieldMoments,
        EstimatorName.BAYESIAN: lambda: FieldBayesian(prior.population),
        EstimatorName.METACAL: lambda: FieldMetacal(seed),
    }
    return kinds[name]()
