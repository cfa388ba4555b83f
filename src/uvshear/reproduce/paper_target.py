"""The base class of targets: what is to be reproduced, in parts that are computed one by one."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Protocol, runtime_checkable

from uvshear.reproduce.finding import Finding
from uvshear.typing import Array


@runtime_checkable
class HasDuration(Protocol):
    """A task that knows about how long it takes."""

    @property
    def seconds(self) -> float:
        """Estimated processor time [s]."""
        ...


@dataclass(frozen=True)
class PaperTarget(ABC):
    """A table, a figure or a claim of Rivi & Miller 2018.

    A subclass is a frozen dataclass whose fields are the settings that determine the result. The work is divided into
    parts, which do not depend on one another and can be computed in any process.

    Attributes
    ----------
    name
        Name of the target on the command line.
    title
        Heading of its section.
    is_alone
        Whether its parts are computed one after the other in this process, because they use workers themselves.

    Parameters
    ----------
    seed
        Seed of the random numbers.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    is_alone: ClassVar[bool] = False

    seed: int = 1

    @abstractmethod
    def tasks(self) -> Mapping[str, Any]:
        """Return what is to be computed for each part, by the name of the part; it is picklable."""

    @abstractmethod
    def measure(self, task: Any) -> Mapping[str, Array]:
        """Compute one part: numbers by their names."""

    @abstractmethod
    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Return the result that follows from all parts, given by their names."""

    def seconds(self) -> float:
        """Estimate the processor time of all parts, for reports of the progress [s]."""
        tasks = self.tasks().values()
        return sum(task.seconds if isinstance(task, HasDuration) else 1.0 for task in tasks)

    def settings(self) -> dict[str, str]:
        """Return the fields that determine the result, as text."""
        return {each.name: repr(getattr(self, each.name)) for each in fields(self)}
