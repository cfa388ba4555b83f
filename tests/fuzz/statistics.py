"""Files of statistics, mutated as tables and as bytes."""

import shutil
from pathlib import Path

import numpy as np

from tests.fuzz.case import Kind, Reading
from tests.fuzz.tables import mutate_table, read

COLUMNS = (
    *("id", "flag_moments", "flag_bayesian", "flag_metacal", "lattice", "columns"),
    *("log_likelihood", "flux_terms", "variance_terms"),
)


class Statistics(Kind):
    """Files of statistics, which all estimators but the mean read."""

    variants = ("shapes.stats.fits",)

    def copied(self, clean: Path, variant: str, directory: Path) -> Path:
        """Copy the shapes as well."""
        shutil.copy(clean / "shapes.fits", directory)
        return super().copied(clean, variant, directory)

    def mutate(self, clean: Path, variant: str, path: Path, rng: np.random.Generator) -> str:
        """Mutate once, any column."""
        names = tuple(read(path).colnames)
        return mutate_table(path, rng, COLUMNS if rng.integers(2) else names)

    def readings(self, clean: Path, variant: str, path: Path) -> tuple[Reading, ...]:
        """Return the commands."""
        shapes = path.with_name("shapes.fits")
        outputs = {
            name: path.with_name(f"{name}.json") for name in ("moments", "bayesian", "metacal")
        }
        return tuple(
            Reading(("shear", str(shapes), "--estimator", name, "-o", str(output)), output)
            for name, output in outputs.items()
        )

    def is_valid(self, clean: Path, variant: str, path: Path) -> bool:
        """Tell that no change is valid: the checksums of the rows find it."""
        return False
