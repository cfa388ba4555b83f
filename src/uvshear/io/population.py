"""A population of galaxies in a JSON file: one that a Bayesian estimate is to assume, or one that was fitted.

.. code-block:: json

    {"flux": {"index": -1.34, "minimum_ujy": 10, "maximum_ujy": 200},
     "size": {"intercept": -0.93, "slope": 0.33, "sigma": 0.3136},
     "ellipticity": {"c": 0.2298, "e0": 0.0732, "maximum": 0.804}}

Parameters that are left out have the values of Rivi & Miller 2018. ``PowerLawFlux``, ``SizeFluxRelation`` and
``DiscEllipticityPrior`` define them.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from uvshear.errors import InputError
from uvshear.estimators.population import PARAMETERS, UnlensedPopulation, unit_of
from uvshear.io.records import finite, read_record

_RANGES = {
    "index": (-10.0, 10.0),
    "slope": (-10.0, 10.0),
    "intercept": (-100.0, 100.0),
    "sigma": (1e-2, 10.0),
    "c": (1e-4, 1e3),
    "e0": (1e-4, 1e3),
    "maximum": (1e-2, 1.0),
    "minimum_ujy": (1e-6, 1e12),
    "maximum_ujy": (1e-6, 1e12),
}
"""Smallest and largest values of parameters: values beyond these are unphysical, and integrals would fail."""

_ERROR = "_err"


def read_population(path: Path | str) -> UnlensedPopulation:
    """Read a population from a file of its own, or from the entry ``population`` in the file of a shear or a bias."""
    path = Path(path)
    record = read_record(path, "a population")
    parts = record.get("population", record)
    entries = f"the entries {', '.join(PARAMETERS)}"
    if not isinstance(parts, dict):
        raise InputError(f"{path}: the population is not an object with {entries}")
    if unknown := sorted(set(parts) - set(PARAMETERS)):
        raise InputError(f"{path}: unknown entry '{unknown[0]}'; a population has {entries}")
    population = UnlensedPopulation()
    for part, values in parts.items():
        given = _values(path, part, values)
        try:
            distribution = replace(getattr(population, part), **given)
        except InputError as error:
            raise InputError(f"{path}: {error}") from error
        population = replace(population, **{part: distribution})
    return population


def _values(path: Path, part: str, values: object) -> Mapping[str, float]:
    """Return the parameters of a part of a population by the fields of its class, in SI."""
    fields = PARAMETERS[part]
    if not isinstance(values, dict):
        raise InputError(
            f"{path}: '{part}' is not an object with the parameters {', '.join(fields)}"
        )
    found = {}
    for name in values:
        if name.removesuffix(_ERROR) not in fields:
            raise InputError(
                f"{path}: unknown parameter '{name}' of '{part}'; its parameters are {', '.join(fields)}"
            )
        if name.endswith(_ERROR):
            continue
        if (value := finite(values, name)) is None:
            raise InputError(f"{path}: the parameter '{name}' of '{part}' is not a finite number")
        low, high = _RANGES[name]
        if not low <= value <= high:
            raise InputError(
                f"{path}: the parameter '{name}' of '{part}' is {value:g}; it must lie between {low:g} and {high:g}"
            )
        found[fields[name]] = value * unit_of(name)
    return found
