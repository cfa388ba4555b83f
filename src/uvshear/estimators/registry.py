"""Estimators by name."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final, TypeAlias, cast

from uvshear.errors import InputError
from uvshear.estimators.estimator import Estimator
from uvshear.plugins import Registry

ESTIMATORS: Final = Registry(
    "estimator",
    "uvshear.estimators",
    {
        "mean": "uvshear.estimators.mean:Mean",
        "moments": "uvshear.estimators.moments:Moments",
        "bayesian": "uvshear.estimators.bayesian:Bayesian",
        "metacal": "uvshear.estimators.metacal:Metacal",
    },
    {"likelihood": "bayesian"},
)
"""Estimators of the package, and those that other packages register in the group ``uvshear.estimators``."""

EstimatorLike: TypeAlias = str | Estimator | type[Estimator]
"""An estimator, its class, or its name."""


def estimator_of(given: EstimatorLike) -> Estimator:
    """Return an estimator from itself, from its class, or from its name."""
    found = ESTIMATORS.find(given) if isinstance(given, str) else given
    if isinstance(found, type) and issubclass(found, Estimator):
        found = found()
    if not isinstance(found, Estimator):
        raise InputError(
            f"{given!r} is not an estimator of the shear; a name ({', '.join(ESTIMATORS.names())}), or an"
            " uvshear.Estimator, is needed"
        )
    return found


def estimators_of(given: EstimatorLike | Sequence[EstimatorLike]) -> tuple[Estimator, ...]:
    """Return estimators from names joined by commas, or from estimators, classes and names; each name once."""
    parts = given.split(",") if isinstance(given, str) else given
    if not isinstance(parts, Iterable):
        parts = (parts,)
    found: dict[str, Estimator] = {}
    for part in parts:
        estimator = estimator_of(part.strip() if isinstance(part, str) else part)
        found.setdefault(estimator.name, estimator)
    return tuple(found.values())


def configured(
    estimator: Estimator,
    *,
    asked: Mapping[str, Any] | None = None,
    offered: Mapping[str, Any] | None = None,
) -> Estimator:
    """Return the estimator with other values of the fields of its dataclass.

    Parameters
    ----------
    asked
        Fields that the estimator must have, with their values.
    offered
        Fields that are set only if the estimator has them.

    Raises
    ------
    InputError
        The estimator lacks a field that was asked for.
    """
    known = set(getattr(estimator, "__dataclass_fields__", {}))
    for name in asked or {}:
        if name not in known:
            raise InputError(f"the estimator '{estimator.name}' has no setting '{name}'")
    wanted = {name: value for name, value in (offered or {}).items() if name in known}
    wanted |= dict(asked or {})
    return cast(Any, replace)(estimator, **wanted) if wanted else estimator
