"""Options of estimators of the shear, which several commands share."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from uvshear.cli.registered import named_by
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.estimators import Estimator

NAMES: Final = "mean, moments, bayesian, metacal"
"""The package's own estimators; those that other packages register are known too."""

PAPER, FITTED = "paper", "fitted"
PRIOR_METAVAR: Final = f"{PAPER}|{FITTED}|FILE"


def estimator_named(
    name: str,
    *,
    prior: str = PAPER,
    wraps: str | None = None,
    position_sigma: float | None = None,
    option: str = "--estimator",
    seed: int = 1,
) -> "Estimator":
    """Return the estimator of a name with the settings of the options.

    Parameters
    ----------
    prior
        Population of the galaxies: that of the paper, one fitted to the sample, or one read from a file.
    wraps
        Estimator that is wrapped, with the same prior.
    position_sigma
        Standard error of the catalogue's positions [rad], for estimators that take account of it.
    option
        Option that has the name, for messages.
    """
    from uvshear.estimators.registry import configured, estimator_of

    with named_by(option, name):
        estimator = estimator_of(name)
    settings: dict[str, Any] = {}
    if wraps is not None:
        if not hasattr(estimator, "wrapped"):
            raise InputError(
                f"--wraps {wraps}: {option} {name} does not wrap another estimator; only metacal does"
            )
        settings["wrapped"] = estimator_named(
            wraps, prior=prior, position_sigma=position_sigma, option="--wraps", seed=seed
        )
    elif prior != PAPER:
        if not hasattr(estimator, "fits_population"):
            raise InputError(
                f"--prior {prior}: {option} {name} has no prior; only bayesian has one"
            )
        settings |= _population(prior)
    offered: dict[str, Any] = {"seed": seed}
    if position_sigma is not None:
        offered["position_sigma"] = position_sigma
    return configured(estimator, asked=settings, offered=offered)


def _population(prior: str) -> dict[str, object]:
    from uvshear.io.population import read_population

    if prior == FITTED:
        return {"fits_population": True}
    if not Path(prior).exists():
        raise InputError(
            f"--prior {prior}: is neither '{PAPER}' nor '{FITTED}' nor an existing file"
        )
    return {"population": read_population(Path(prior))}
