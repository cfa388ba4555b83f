"""The noise of visibilities, estimated from the visibilities themselves, and compared with their weights."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.accumulate import Accumulator, accumulate
from uvshear.interferometer.origin import Origin, origin_of, parts_of
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.typing import Array, Float

MOST_PAIRS = 2**20
"""Number of differences after which no more are gathered: the ratio is then known to 0.1 per cent."""

FEWEST_PAIRS = 100
"""Number of differences below which no ratio is given."""

_COMPARABLE = 0.1
"""Differences between channels and differences between integrations are compared where the number of the less numerous
kind is at least this fraction of the other."""

Differences = tuple[Float[Array, " channel_pair"], Float[Array, " integration_pair"]]
"""Squared differences over their expected variance, between channels and between integrations."""


class NoiseRatioAccumulator(Accumulator[float | None]):
    r"""Estimates the standard deviation of the noise over the one that the weights imply.

    Neighbours are channels of a row, or integrations of a baseline, whichever differ less: the visibilities of bright
    sources far from the phase centre also differ between neighbours. With D the difference of two samples of weights w,

    .. math:: \frac{\sigma^2}{\sigma_w^2} = \frac{\mathrm{med}\,\{|D|^2 / (1/w_1 + 1/w_2)\}}{2 \ln 2}

    The result is None where fewer than a hundred pairs have weight, or where it is not known which rows belong to one
    baseline. In a large set the first million pairs are used. Channels that were smoothed (Hanning) have correlated
    noise, which makes the estimate too small.
    """

    def __init__(self) -> None:
        self._chunks: list[Differences] = []
        self._pairs = (0, 0)

    @property
    def is_satisfied(self) -> bool:
        """Whether there are enough pairs between channels, or between integrations."""
        return max(self._pairs) >= MOST_PAIRS

    def add(self, seen: Visibilities) -> None:
        """Take the differences of the next chunk, unless there are enough."""
        if not self.is_satisfied:
            self._take((_between_channels(seen), _between_integrations(seen)))

    def merge(self, later: Self) -> None:
        """Take the differences of later chunks until there are enough."""
        for differences in later._chunks:
            if not self.is_satisfied:
                self._take(differences)

    def result(self) -> float | None:
        """Return the ratio."""
        medians = [
            float(np.median(np.concatenate(parts)))
            for parts, count in zip(zip(*self._chunks, strict=True), self._pairs, strict=False)
            if count >= max(FEWEST_PAIRS, _COMPARABLE * max(self._pairs))
        ]
        return math.sqrt(min(medians) / (2 * math.log(2))) if medians else None

    def _take(self, differences: Differences) -> None:
        self._chunks.append(differences)
        of_channels, of_integrations = self._pairs
        self._pairs = of_channels + len(differences[0]), of_integrations + len(differences[1])


def noise_over_weights(observation: Observation) -> float | None:
    """Estimate the noise over the one that the weights imply (:class:`NoiseRatioAccumulator`)."""
    ratio: float | None
    (ratio,) = accumulate(observation, [NoiseRatioAccumulator()])
    return ratio


@dataclass(frozen=True)
class ScaledObservation:
    """An observation whose weights are divided by the square of a noise ratio."""

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
            yield replace(chunk, weights=weights)


def scaled_to_its_noise(observation: Observation) -> ScaledObservation:
    """Read the start of an observation, and scale its weights to the noise that is found there."""
    ratio = noise_over_weights(observation)
    if not ratio:
        raise InputError(
            f"{origin_of(observation).name}: the noise cannot be estimated from neighbouring samples (there are too few"
            " of them, or they have no noise); use the noise of the weights (--noise weights)"
        )
    return ScaledObservation(observation, ratio)


def _between_channels(seen: Visibilities) -> Float[Array, " pair"]:
    return _differences(
        (seen.stokes_i[:, :-1], seen.weights[:, :-1]), (seen.stokes_i[:, 1:], seen.weights[:, 1:])
    )


def _between_integrations(seen: Visibilities) -> Float[Array, " pair"]:
    taken = seen.integrations
    if taken is None:
        return np.zeros(0)
    order = np.lexsort((taken.time, taken.antennas[:, 1], taken.antennas[:, 0]))
    first, second = order[:-1], order[1:]
    is_pair = (taken.antennas[first] == taken.antennas[second]).all(axis=1)
    # Across a gap, for example a visit to a calibrator, the sky has turned.
    apart = taken.time[second] - taken.time[first]
    if is_pair.any():
        is_pair &= apart < 1.5 * np.median(apart[is_pair])
    first, second = first[is_pair], second[is_pair]
    return _differences(
        (seen.stokes_i[first], seen.weights[first]), (seen.stokes_i[second], seen.weights[second])
    )


def _differences(
    first: tuple[Array, Float[Array, "row chan"]], second: tuple[Array, Float[Array, "row chan"]]
) -> Float[Array, " pair"]:
    (first_vis, first_weight), (second_vis, second_weight) = first, second
    both = (first_weight > 0) & (second_weight > 0)
    variance = 1 / first_weight[both].astype(float) + 1 / second_weight[both]
    return np.abs(first_vis[both] - second_vis[both]) ** 2 / variance
