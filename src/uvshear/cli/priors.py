"""Where the population of a Bayesian shear comes from: the paper, the sample itself, or a file."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.estimators.evidence import UnlensedPopulation

PAPER, FITTED, FILE = "paper", "fitted", "file"
METAVAR = f"{PAPER}|{FITTED}|FILE"


@dataclass(frozen=True)
class Prior:
    """A population, as an option names it.

    Parameters
    ----------
    source
        ``paper``, ``fitted``, or ``file``.
    population
        The one that is taken, or that a fit begins with.
    """

    source: str
    population: "UnlensedPopulation"

    @classmethod
    def from_option(cls, name: str) -> Self:
        """Read it, if it is a file."""
        from uvshear.estimators.evidence import UnlensedPopulation
        from uvshear.io.population import read_population

        if name in (PAPER, FITTED):
            return cls(name, UnlensedPopulation())
        if not Path(name).exists():
            raise InputError(f"--prior {name}: is neither {PAPER} nor {FITTED}, nor a file")
        return cls(FILE, read_population(Path(name)))

    @property
    def is_fitted(self) -> bool:
        """Whether it is fitted to the sample."""
        return self.source == FITTED
