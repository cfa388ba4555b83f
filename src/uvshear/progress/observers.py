"""Several observers of one computation."""

from collections.abc import Mapping

from uvshear.progress.observer import Observer
from uvshear.progress.stage import Stage


class Observers(Observer):
    """Passes everything on to several observers, in their order."""

    def __init__(self, *observers: Observer) -> None:
        self._observers = observers

    def begin(self, stage: Stage, *then: Stage) -> None:
        """Pass on that a stage begins."""
        for observer in self._observers:
            observer.begin(stage, *then)

    def advance(self, done: float, expected: float) -> None:
        """Pass on how far the stage is."""
        for observer in self._observers:
            observer.advance(done, expected)

    def foresee(self, *then: Stage) -> None:
        """Pass on which stages are now expected."""
        for observer in self._observers:
            observer.foresee(*then)

    def note(self, facts: Mapping[str, object]) -> None:
        """Pass on facts about the stage."""
        for observer in self._observers:
            observer.note(facts)

    def finish(self) -> None:
        """Pass on that the last stage has ended."""
        for observer in self._observers:
            observer.finish()
