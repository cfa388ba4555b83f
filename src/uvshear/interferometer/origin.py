"""Origin of the visibilities of an observation: optional members of observations, and their defaults.

An observation needs a phase centre and chunks. An observation of several parts, for example files, also has ``parts``;
an observation that was opened from a file, or that changes the weights of another, has ``origin``.
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from uvshear.interferometer.visibilities import Observation


@dataclass(frozen=True)
class Origin:
    """Source of the visibilities of one part of an observation.

    Parameters
    ----------
    observation
        The observation as it was opened or simulated, before anything was done to its weights.
    name
        Name for messages, for example the path of a file.
    weights_tell_noise
        Whether the weights are those that came with the data, and claim to be 1/sigma^2 of their noise.
    """

    observation: Observation
    name: str = "the observation"
    weights_tell_noise: bool = True


@runtime_checkable
class HasParts(Protocol):
    """An observation that consists of others, read one after the other."""

    @property
    def parts(self) -> tuple[Observation, ...]:
        """The observations in the order in which they are read."""
        ...


@runtime_checkable
class HasOrigin(Protocol):
    """An observation that knows where its visibilities come from."""

    def origin(self) -> Origin:
        """Return the origin."""
        ...


@runtime_checkable
class HasNotices(Protocol):
    """An observation that has facts about its data which a user should know before they are measured."""

    def notices(self) -> tuple[str, ...]:
        """Return a sentence for each fact, from metadata alone."""
        ...


def parts_of(observation: Observation) -> tuple[Observation, ...]:
    """Return the parts of an observation that has any, else the observation itself."""
    return observation.parts if isinstance(observation, HasParts) else (observation,)


def origin_of(observation: Observation) -> Origin:
    """Return the origin of an observation, which is the observation itself unless it names another."""
    return observation.origin() if isinstance(observation, HasOrigin) else Origin(observation)
