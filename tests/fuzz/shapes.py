"""Tables of shapes, mutated as tables, as text and as bytes."""

import shutil
from pathlib import Path

import numpy as np

from tests.fuzz.case import Kind, Reading
from tests.fuzz.tables import mutate_table
from tests.fuzz.valid_tables import is_another_valid_table

COLUMNS = ("id", "l", "m", "flux", "e1", "e2", "e_sigma", "weight", "snr", "flag", "detection")
RANGES = {
    "l": (-1, 1),
    "m": (-1, 1),
    "e1": (-1, 1),
    "e2": (-1, 1),
    "e_sigma": (0, 1e6),
    "weight": (0, 1e6),
    "snr": (-1e15, 1e15),
}


class Shapes(Kind):
    """Tables of shapes, from which `shear` estimates."""

    variants = ("shapes.fits", "shapes.ecsv")

    def copied(self, clean: Path, variant: str, directory: Path) -> Path:
        """Copy the statistics as well."""
        for kind in ("stats", "sky"):
            stem = "shapes" if variant == "shapes.fits" else variant
            if (other := clean / f"{stem}.{kind}.fits").exists():
                shutil.copy(other, directory)
        return super().copied(clean, variant, directory)

    def mutate(self, clean: Path, variant: str, path: Path, rng: np.random.Generator) -> str:
        """Mutate once."""
        return mutate_table(path, rng, COLUMNS)

    def readings(self, clean: Path, variant: str, path: Path) -> tuple[Reading, ...]:
        """Return the commands."""
        mean, moments = path.with_name("mean.json"), path.with_name("moments.json")
        return (
            Reading(("shear", str(path), "-o", str(mean)), mean),
            Reading(("shear", str(path), "--estimator", "moments", "-o", str(moments)), moments),
        )

    def is_valid(self, clean: Path, variant: str, path: Path) -> bool:
        """Compare what the tables contain."""
        return is_another_valid_table(path, clean / variant, RANGES)
