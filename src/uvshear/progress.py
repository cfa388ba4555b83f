"""How much of a long work is done."""

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Called with what is done and what there is; there may turn out to be more."""


class Meter:
    """Work done and work foreseen, in whatever unit: galaxies, or nanoseconds."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self._done = self._total = 0.0

    def expect(self, work: float) -> None:
        """Foresee more work."""
        self._total += work

    def finish(self) -> None:
        """Nothing is left to do, whatever was foreseen."""
        self._total = self._done
        self.add(0.0)

    def add(self, work: float = 1.0) -> None:
        """Tell of work done."""
        self._done += work
        if self._progress is not None:
            self._progress(round(self._done), round(max(self._total, self._done)))
