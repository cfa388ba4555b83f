"""A store of states in memory, which interrupts the computation at any moment."""

import pickle
from typing import Any

from uvshear.extraction.state_store import Results, StateStore


class InterruptionError(Exception):
    """The computation is interrupted."""


class InterruptingStore(StateStore):
    """A store that interrupts the computation after a number of states and results; states are pickled, as in files."""

    is_due = True

    def __init__(self) -> None:
        self.states: dict[str, bytes] = {}
        self.found: dict[str, dict[Any, bytes]] = {}
        self.events: list[str] = []
        self.most = 10**9

    def interrupted_after(self, more: int) -> "InterruptingStore":
        """Interrupt after this number of further events."""
        self.most = len(self.events) + more
        return self

    def happened(self, name: str) -> None:
        self.events.append(name)
        if len(self.events) >= self.most:
            raise InterruptionError(name)

    def load(self, name: str) -> Any:
        return pickle.loads(self.states[name]) if name in self.states else None

    def save(self, name: str, state: Any) -> None:
        self.states[name] = pickle.dumps(state, 5)
        self.happened(name)

    def results(self, name: str) -> Results[Any]:
        return _Kept(self, name)

    def part(self, name: str) -> StateStore:
        return _Within(self, name)


class _Kept(Results[Any]):
    def __init__(self, store: InterruptingStore, name: str) -> None:
        super().__init__()
        self._store, self._name = store, name
        self._kept = store.found.setdefault(name, {})
        self._found = {key: pickle.loads(value) for key, value in self._kept.items()}

    def add(self, key: Any, result: Any) -> None:
        super().add(key, result)
        self._kept[key] = pickle.dumps(result, 5)
        self._store.happened(self._name)


class _Within(StateStore):
    is_due = True

    def __init__(self, whole: StateStore, name: str) -> None:
        self.whole, self.name = whole, name

    def load(self, name: str) -> Any:
        return self.whole.load(f"{self.name}.{name}")

    def save(self, name: str, state: Any) -> None:
        self.whole.save(f"{self.name}.{name}", state)

    def results(self, name: str) -> Results[Any]:
        return self.whole.results(f"{self.name}.{name}")

    def part(self, name: str) -> StateStore:
        return _Within(self, name)
