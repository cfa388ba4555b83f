"""How much of a measurement is done."""

from uvshear.measurement.extraction import Progress


class Meter:
    """Work done and work foreseen, in nanoseconds or so."""

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

    def add(self, work: float) -> None:
        """Tell of work done."""
        self._done += work
        if self._progress is not None:
            self._progress(round(self._done / 1e6), round(max(self._total, self._done) / 1e6))
