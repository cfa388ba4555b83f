"""A stage of a long computation."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Stage:
    """A stage of a long computation, as it is expected.

    Parameters
    ----------
    name
        Name for the user, such as "major cycle 3".
    cost
        Estimated work, in a unit that all stages of the computation share; 0 if it is not known.
    amount
        Number of units of which the stage consists; 0 if it is not known.
    unit
        What the stage consists of, in the plural, such as "visibilities"; empty if its rate is of no interest.
    kind
        Stages of one kind have costs that are wrong by about the same factor. Each stage is of its own kind unless
        given.
    pace
        Time that a unit of work takes, as far as it is known beforehand [s]; 0 if it is not known.
    """

    name: str
    cost: float = 0.0
    amount: float = 0.0
    unit: str = ""
    kind: str = ""
    pace: float = 0.0

    @property
    def unit_cost(self) -> float:
        """Estimated work of a unit."""
        return self.cost / self.amount if self.cost > 0 and self.amount > 0 else 1.0
