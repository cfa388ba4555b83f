"""JSON files that commands read: simulated biases, populations, and shears with a population."""

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np

from tests.fuzz.case import Kind, Reading
from tests.fuzz.wild import damage, wild_number, word

VALUES: tuple[Any, ...] = (
    *(None, True, False, "", "x", [], {}, [1, 2], {"a": 1}, -1, 0, 1, 0.5, 10**400, -1e308),
    *(float("nan"), float("inf"), 1e300, "1.0", [[[]]], "nan", {"flux": {}}, 2**63),
)


class JsonFiles(Kind):
    """Biases, which `shear` removes, and populations, which `bayesian` assumes."""

    variants = ("bias.json", "population.json", "shear.json")

    def mutate(self, clean: Path, variant: str, path: Path, rng: np.random.Generator) -> str:
        """Mutate a value, a key, or bytes."""
        if rng.random() < 0.3:
            return damage(rng, path)
        record = json.loads(path.read_text())
        # Of the file of a shear, only the population is read.
        owner, key = _drawn(record["population"] if variant == "shear.json" else record, rng)
        choice = rng.integers(5)
        if choice == 0:
            del owner[key]
            words = f"{key} removed"
        elif choice == 1 and isinstance(owner, dict):
            names = [f"{key}_err", key.upper(), "", "size", "c1", "x" * 50]
            # The name of another value would change that one as well.
            new = str(rng.choice([name for name in names if name not in owner]))
            owner[new] = owner.pop(key)
            words = f"{key} renamed to {new}"
        elif choice == 2 and isinstance(owner[key], int | float):
            owner[key] = wild_number(rng, float(owner[key]))
            words = f"{key} = {owner[key]!r}"
        else:
            owner[key] = copy.deepcopy(VALUES[rng.integers(len(VALUES))])
            if rng.integers(8) == 0:
                owner[key] = word(rng)
            words = f"{key} = {str(owner[key])[:40]}"
        path.write_text(json.dumps(record))
        return words

    def readings(self, clean: Path, variant: str, path: Path) -> tuple[Reading, ...]:
        """Return the commands."""
        found = path.with_name("found.json")
        with_it = (
            ("--estimator", "moments", "--calibration", str(path))
            if variant == "bias.json"
            else ("--estimator", "bayesian", "--prior", str(path))
        )
        return (Reading(("shear", str(clean / "shapes.fits"), *with_it, "-o", str(found)), found),)

    def is_valid(self, clean: Path, variant: str, path: Path) -> bool:
        """Tell whether numbers have become others, or parameters of a population are left to their usual values."""
        new, old = (
            json.loads(one.read_text(encoding="utf-8-sig")) for one in (path, clean / variant)
        )
        if variant == "shear.json":
            new, old = new["population"], old["population"]
        return _is_like(new, old, is_population=variant != "bias.json")


def _drawn(record: Any, rng: np.random.Generator) -> tuple[Any, Any]:
    """Draw a value of a record, however deep."""
    keys = list(record) if isinstance(record, dict) else list(range(len(record)))
    key = keys[rng.integers(len(keys))]
    inside = record[key]
    if isinstance(inside, dict | list) and inside and rng.integers(3):
        return _drawn(inside, rng)
    return record, key


def _is_like(new: Any, old: Any, *, is_population: bool) -> bool:
    if isinstance(old, dict):
        if not isinstance(new, dict) or (not is_population and set(new) != set(old)):
            return False
        return all(
            _is_like(value, old[key], is_population=is_population)
            for key, value in new.items()
            if key in old
        )
    if isinstance(old, int | float) and not isinstance(old, bool):
        return isinstance(new, int | float) and not isinstance(new, bool)
    return type(new) is type(old)
