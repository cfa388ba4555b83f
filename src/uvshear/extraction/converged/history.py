"""The convergence of an extraction, major cycle by major cycle."""

from dataclasses import dataclass
from typing import Self

from uvshear.extraction.converged.minor_cycle import MOST_ITERATIONS, Moves, rms
from uvshear.typing import Array, Float

FARTHEST = 5.0
"""Largest estimate of all further changes, over the last one: changes that hardly shrink tell of no end."""


@dataclass(frozen=True)
class History:
    """The change of the sky in each major cycle, in units of the noise.

    Parameters
    ----------
    change_rms, change_max
        Change of the sources in each major cycle with its minor cycle: the rms and the largest.
    moves
        Largest moves within each minor cycle.
    """

    change_rms: tuple[float, ...] = ()
    change_max: tuple[float, ...] = ()
    moves: tuple[Moves, ...] = ()

    def __len__(self) -> int:
        return len(self.change_rms)

    def with_cycle(self, change: Float[Array, " source"], moves: Moves) -> Self:
        """Return the history with one more major cycle."""
        return type(self)(
            (*self.change_rms, rms(change)),
            (*self.change_max, float(change.max())),
            (*self.moves, moves),
        )

    @property
    def left_undone(self) -> float:
        """Change that another major cycle would bring, rms over the sources."""
        return self.change_rms[-1] * self.shrinkage

    @property
    def left_undone_most(self) -> float:
        """Largest change of a source that another major cycle would bring."""
        return self.change_max[-1] * self.shrinkage

    @property
    def shrinkage(self) -> float:
        """Factor from one change of the sky to the next: changes shrink by about the same factor each time."""
        if len(self) == 1:
            return 1.0
        before, last = self.change_rms[-2:]
        return min(last / before, 1.0) if before > 0 else 0.0

    @property
    def left_to_the_limit(self) -> float:
        """Sum of all further changes over the last one, if they go on to shrink by the same factor."""
        factor = self.shrinkage
        return min(factor / (1 - factor), FARTHEST) if factor < 1 else FARTHEST

    @property
    def is_diverging(self) -> bool:
        """Whether the last major cycle changed the sky more than the one before, and by more than the noise."""
        return len(self) > 1 and self.change_rms[-1] > max(self.change_rms[-2], 1.0)

    @property
    def is_restless(self) -> bool:
        """Whether the sources have not come to rest in the last minor cycle."""
        return len(self) > 0 and len(self.moves[-1]) == MOST_ITERATIONS

    def last(self) -> dict[str, object]:
        """Return how the last major cycle changed the sky, for reports of the progress."""
        return {
            "change_rms": round(self.change_rms[-1], 4),
            "change_max": round(self.change_max[-1], 4),
            "left_undone": round(self.left_undone, 4),
            "moves": _rounded_moves(self.moves[-1]),
        }

    def record(self) -> dict[str, object]:
        """Return the numbers that are stored with the shapes."""
        return {
            "major_cycles": len(self),
            "minor_cycles": [_rounded_moves(moves) for moves in self.moves],
            "change_rms": _rounded(self.change_rms),
            "change_max": _rounded(self.change_max),
            "left_undone": round(self.left_undone, 4),
            "left_undone_most": round(self.left_undone_most, 4),
        }


def _rounded(values: tuple[float, ...]) -> list[float]:
    return [round(value, 4) for value in values]


def _rounded_moves(moves: Moves) -> list[list[float]]:
    return [[round(change, 3) for change in pair] for pair in moves]
