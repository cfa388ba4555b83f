"""Layouts, mutated as text."""

from pathlib import Path

import numpy as np

from tests.fuzz.case import Kind, Reading
from tests.fuzz.clean_inputs import TRACK
from tests.fuzz.wild import damage, wild_number, word


class Layouts(Kind):
    """Layouts, which `layouts` and `simulate` read; whatever their numbers are, the results show them."""

    variants = ("array.txt",)

    def mutate(self, clean: Path, variant: str, path: Path, rng: np.random.Generator) -> str:
        """Mutate a word, a line, or bytes."""
        lines = path.read_text().splitlines()
        number = int(rng.integers(len(lines)))
        cells = lines[number].split()
        place = int(rng.integers(len(cells)))
        choice = rng.integers(6)
        if choice == 0:
            return damage(rng, path)
        if choice == 1:
            cells[place] = word(rng)
        elif choice == 2:
            cells[place] = repr(wild_number(rng, 5108065.0))
        elif choice == 3:
            del cells[place]
        elif choice == 4:
            cells = lines[int(rng.integers(len(lines)))].split()
        else:
            lines = [line.replace(" ", str(rng.choice([",", "\t", "\n"]))) for line in lines]
        if choice != 5:
            lines[number] = " ".join(cells)
        path.write_text("\n".join(lines))
        return f"line {number + 1}: {lines[number]!r}"

    def readings(self, clean: Path, variant: str, path: Path) -> tuple[Reading, ...]:
        """Return the commands."""
        picture, field = path.with_name("map.png"), path.with_name("new.ms")
        return (
            Reading(("layouts", str(path), "-o", str(picture)), picture),
            Reading(
                (
                    *("simulate", "--layout", str(path), "--catalogue", str(clean / "cat.ecsv")),
                    *(*TRACK.split(), "--band-mhz", "950", "1190", "--no-noise", "-o", str(field)),
                ),
                field,
            ),
        )

    def is_valid(self, clean: Path, variant: str, path: Path) -> bool:
        """Return that no results are compared."""
        return False
