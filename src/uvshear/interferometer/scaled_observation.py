"""Observations whose weights are scaled to the noise that is found in their data."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.noise_estimate import noise_over_weights
from uvshear.interferometer.origin import Origin, origin_of, parts_of
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import Observation, Visibilities


@dataclass(frozen=True)
class ScaledObservation:
    """An observation whose weights are divided by the square of a noise ratio.

    ``uvshear.measure`` corrects the ratio by the residual of the fitted sky.
    """

    observation: Observation
    noise: float

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self.observation.phase_centre

    @property
    def parts(self) -> tuple["ScaledObservation", ...]:
        """Parts of the observation, each scaled."""
        inner = parts_of(self.observation)
        return (
            tuple(replace(self, observation=part) for part in inner) if len(inner) > 1 else (self,)
        )

    def origin(self) -> Origin:
        """Return the origin of the observation that is scaled."""
        return replace(origin_of(self.observation), weights_tell_noise=False)

    def chunks(self) -> Iterator[Visibilities]:
        """Read everything once."""
        for chunk in screened_chunks(self.observation):
            weights = (chunk.weights / self.noise**2).astype(chunk.weights.dtype)
            powers = None if chunk.hand_powers is None else chunk.hand_powers / self.noise**2
            yield replace(chunk, weights=weights, hand_powers=powers)

    def corrected(self, ratio: float) -> "ScaledObservation":
        """Return the observation with its weights divided by the square of a further ratio."""
        return replace(self, noise=self.noise * ratio)


def scaled_to_its_noise(observation: Observation) -> ScaledObservation:
    """Read the start of an observation, and scale its weights to the noise that is found there."""
    found = noise_over_weights(observation)
    if found is None or found.ratio == 0:
        raise InputError(
            f"{origin_of(observation).name}: the noise cannot be estimated from the data (there are too few"
            " visibilities, they have no noise, or there are neither two parallel hands nor successive integrations or"
            " neighbouring channels to compare); use the noise of the weights (--noise weights)"
        )
    return ScaledObservation(observation, found.ratio)
