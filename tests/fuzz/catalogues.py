"""Catalogues in all formats, mutated as text, as tables and as bytes."""

from pathlib import Path

import numpy as np

from tests.fuzz.case import Kind, Reading
from tests.fuzz.clean_inputs import TRACK
from tests.fuzz.tables import mutate_table
from tests.fuzz.valid_tables import is_another_valid_table

COLUMNS = (
    *("id", "ra", "dec", "flux", "spectral_index", "scale_length"),
    *("RA", "DEC", "Total_flux", "Maj", "Min", "PA", "E_Maj", "DC_Maj", "Source_id"),
)
RANGES = {
    "ra": (29.9, 30.1),
    "dec": (-30.1, -29.9),
    "RA": (29.9, 30.1),
    "DEC": (-30.1, -29.9),
    "flux": (1e-6, 1e6),
    "Total_flux": (1e-12, 1.0),
    "spectral_index": (-100, 100),
    "scale_length": (0, 3e5),
    "Maj": (0, 1),
    "Min": (0, 1),
}
"""Numbers of another sky; a list may have sources that are not in the data."""

OPTIONAL = frozenset(
    {"spectral_index", "scale_length", "flux_err", "shear1", "Profile", "e1", "E1"}
)
"""Columns without which a catalogue is another catalogue."""


class Catalogues(Kind):
    """Catalogues, with which `measure` and in some formats `simulate` work."""

    variants = ("cat.ecsv", "cat.csv", "cat.vot", "cat.fits", "image.srl", "image.srl.fits")

    def mutate(self, clean: Path, variant: str, path: Path, rng: np.random.Generator) -> str:
        """Mutate once."""
        return mutate_table(path, rng, COLUMNS)

    def readings(self, clean: Path, variant: str, path: Path) -> tuple[Reading, ...]:
        """Return the commands."""
        shapes = path.with_name("shapes.fits")
        unit = ("--flux-unit", "uJy") if path.suffix == ".csv" else ()
        prior = ("--size-prior", "catalogue") if variant == "cat.vot" else ()
        measure = (
            *("measure", str(clean / "field.ms"), "--catalogue", str(path), *unit, *prior),
            *("--threads", "1", "-o", str(shapes)),
        )
        if variant != "cat.ecsv":
            return (Reading(measure, shapes),)
        simulate = (
            *("simulate", "--layout", str(clean / "array.txt"), "--catalogue", str(path)),
            *(
                *TRACK.split(),
                "--band-mhz",
                "950",
                "1190",
                "--no-noise",
                "-o",
                str(path.with_name("new.ms")),
            ),
        )
        return Reading(measure, shapes), Reading(simulate, path.with_name("new.ms"))

    def is_valid(self, clean: Path, variant: str, path: Path) -> bool:
        """Compare what the tables contain."""
        return is_another_valid_table(path, clean / variant, RANGES, OPTIONAL)
