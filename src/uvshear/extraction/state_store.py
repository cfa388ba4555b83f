"""Where an extraction stores its state, so that another run can go on from it."""

from abc import ABC, abstractmethod
from collections.abc import Hashable
from typing import Any, Generic, TypeVar

Result = TypeVar("Result")


class Results(Generic[Result]):
    """Results that are found one by one, such as the posteriors of galaxies, by their keys."""

    def __init__(self) -> None:
        self._found: dict[Hashable, Result] = {}

    def __len__(self) -> int:
        return len(self._found)

    def __contains__(self, key: Hashable) -> bool:
        return key in self._found

    def __getitem__(self, key: Hashable) -> Result:
        return self._found[key]

    def add(self, key: Hashable, result: Result) -> None:
        """Add a result."""
        self._found[key] = result


class StateStore(ABC):
    """A place for the states of a computation, each of which has a name and is stored whole or not at all.

    States are picklable.
    """

    @property
    @abstractmethod
    def is_due(self) -> bool:
        """Whether much work would be lost if nothing were saved now."""

    @abstractmethod
    def load(self, name: str) -> Any:
        """Return the state that was saved last under a name; None if there is none."""

    @abstractmethod
    def save(self, name: str, state: Any) -> None:
        """Save a state in the place of an earlier one of the same name."""

    @abstractmethod
    def results(self, name: str) -> Results[Any]:
        """Return the results that were stored under a name; those that are added are stored every now and then."""

    @abstractmethod
    def part(self, name: str) -> "StateStore":
        """Return a store within this one, with names of its own."""


class NoStore(StateStore):
    """A store that keeps nothing, for runs that cannot be continued."""

    is_due = False

    def load(self, name: str) -> None:
        """Return None."""

    def save(self, name: str, state: Any) -> None:
        """Do nothing."""

    def results(self, name: str) -> Results[Any]:
        """Return an empty collection."""
        return Results()

    def part(self, name: str) -> "NoStore":
        """Return this store."""
        return self


NO_STORE = NoStore()
"""The default store, which keeps nothing."""
