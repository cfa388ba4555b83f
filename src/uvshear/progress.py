"""Progress of a long computation."""

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Function that is called with the work done so far and the total work expected, which may grow."""


class Meter:
    """Work that is done and work that is expected, in any unit: galaxies, or nanoseconds."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self._done = self._total = 0.0

    def expect(self, work: float) -> None:
        """Expect more work."""
        self._total += work

    def finish(self) -> None:
        """Report that nothing is left to do, whatever was expected."""
        self._total = self._done
        self.add(0.0)

    def add(self, work: float = 1.0) -> None:
        """Report work that is done."""
        self._done += work
        if self._progress is not None:
            self._progress(round(self._done), round(max(self._total, self._done)))
