"""How large the noise of visibilities is, by the visibilities themselves, against what their weights say."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.typing import Array, Float

MOST_PAIRS = 2**20
"""Differences that are looked at: the ratio is then known to 0.1 per cent."""

FEWEST_PAIRS = 100
_FAIR = 0.1
"""Of the pairs of one kind there must be so many of the other, for them to be compared."""


def noise_over_weights(observation: Observation) -> float | None:
    r"""Estimate the noise's standard deviation over that of the weights, from neighbours' differences.

    Neighbours are channels of a row, or integrations of a baseline, whichever differ less: a bright sky, and one far
    out, differs between them too. With D the difference of two samples, of weights w,

    .. math:: \frac{\sigma^2}{\sigma_w^2} = \frac{\mathrm{med}\,\{|D|^2 / (1/w_1 + 1/w_2)\}}{2 \ln 2}

    None where fewer than a hundred pairs have weight, or nobody knows which rows belong together. Of a large set the
    first million pairs are looked at. Channels that were
    smoothed (Hanning) share noise, and seem quieter than they are.
    """
    found: tuple[list[Array], list[Array]] = ([], [])
    counts = [0, 0]
    for chunk in observation.chunks():
        for way, differences in enumerate((_of_channels(chunk), _of_integrations(chunk))):
            found[way].append(differences)
            counts[way] += len(differences)
        if max(counts) >= MOST_PAIRS:
            break
    medians = [
        float(np.median(np.concatenate(parts)))
        for parts, count in zip(found, counts, strict=True)
        if count >= max(FEWEST_PAIRS, _FAIR * max(counts))
    ]
    return math.sqrt(min(medians) / (2 * math.log(2))) if medians else None


@dataclass(frozen=True)
class ScaledObservation:
    """An observation with weights of another noise."""

    observation: Observation
    noise: float

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self.observation.phase_centre

    def chunks(self) -> Iterator[Visibilities]:
        """Read everything once."""
        for chunk in self.observation.chunks():
            weights = (chunk.weights / self.noise**2).astype(chunk.weights.dtype)
            yield replace(chunk, weights=weights)


def scaled_to_its_noise(observation: Observation) -> ScaledObservation:
    """Return an observation whose weights say how large its noise is, which is read for it."""
    ratio = noise_over_weights(observation)
    if not ratio:
        raise InputError(
            "--noise data: neighbouring samples do not tell the noise (too few of them, or none at all);"
            " --noise weights is needed"
        )
    return ScaledObservation(observation, ratio)


def _of_channels(seen: Visibilities) -> Float[Array, " pair"]:
    return _differences(
        (seen.stokes_i[:, :-1], seen.weights[:, :-1]), (seen.stokes_i[:, 1:], seen.weights[:, 1:])
    )


def _of_integrations(seen: Visibilities) -> Float[Array, " pair"]:
    taken = seen.integrations
    if taken is None:
        return np.zeros(0)
    order = np.lexsort((taken.time, taken.antennas[:, 1], taken.antennas[:, 0]))
    first, second = order[:-1], order[1:]
    is_pair = (taken.antennas[first] == taken.antennas[second]).all(axis=1)
    # Further apart, across a gap or after a calibrator, the sky has turned.
    apart = taken.time[second] - taken.time[first]
    if is_pair.any():
        is_pair &= apart < 1.5 * np.median(apart[is_pair])
    first, second = first[is_pair], second[is_pair]
    return _differences(
        (seen.stokes_i[first], seen.weights[first]), (seen.stokes_i[second], seen.weights[second])
    )


def _differences(
    one: tuple[Array, Float[Array, "row chan"]], other: tuple[Array, Float[Array, "row chan"]]
) -> Float[Array, " pair"]:
    (vis, weight), (other_vis, other_weight) = one, other
    both = (weight > 0) & (other_weight > 0)
    variance = 1 / weight[both].astype(float) + 1 / other_weight[both]
    return np.abs(vis[both] - other_vis[both]) ** 2 / variance
