"""The number of samples that a pass over an observation reads, as far as it is known before."""

from typing import Protocol, runtime_checkable

from uvshear.interferometer.origin import origin_of, parts_of
from uvshear.interferometer.visibilities import Observation


@runtime_checkable
class HasExpectedSamples(Protocol):
    """An observation that knows from its metadata about how many samples it has."""

    def expected_samples(self) -> float:
        """Return the number of samples, with those that will turn out to have no weight."""
        ...


def expected_samples(observation: Observation) -> float:
    """Return the number of samples that a pass reads, for reports of its progress; 0 if it is not known."""
    numbers = [
        part.expected_samples() if isinstance(part, HasExpectedSamples) else 0.0
        for part in (origin_of(each).observation for each in parts_of(observation))
    ]
    return sum(numbers) if all(numbers) else 0.0
