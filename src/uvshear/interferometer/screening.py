"""Samples that cannot be right: they are left out of every pass over the data, and counted by reason."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from uvshear.constants import RADIO_FREQUENCIES
from uvshear.interferometer.averaged_rows import AveragedRows
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.visibilities import Integrations, Observation, Visibilities
from uvshear.typing import Array, Bool, Float

LONGEST_INTEGRATION: Final = 86400.0
"""Length beyond which an integration cannot be real [s]: within a day, every baseline turns once."""

LARGEST_SNR: Final = 1e8
"""Signal-to-noise ratio beyond which a single visibility cannot be real. Squares of larger ones overflow in single
precision."""

LARGEST_WEIGHT: Final = 1e6
"""Ratio of a weight to the 99th percentile of its block beyond which it cannot be real: the noise of a few samples
would be less than a thousandth of that of all others. In sums of single precision, they would swamp the others."""

FEW: Final = 0.99
"""Fraction of the samples of a block that have a smaller weight than those whose weight may be too large."""

NO_TIME: Final = 0.0
"""Time of an integration whose time is not known [MJD s]; it lies in 1858."""


def screened(seen: Visibilities) -> Visibilities:
    """Return the samples, with a weight of 0 for those that cannot be right, and with their numbers by reason.

    A row is left out if its UVW is not finite, is zero (as programs store it for missing antennas), is longer than the
    array, or is shorter or longer than the distance between its antennas; if its time is not finite; or if its
    integration is negative or longer than a day. A channel is left out if its frequency or width cannot be that of a
    radio telescope. An average over a cell is left out if its moments are larger than those of any samples in a cell.
    A sample is left out if it is not finite or is impossibly large, or if its weight dwarfs all
    others.
    """
    if seen.is_screened:
        return seen
    seen = replace(seen, is_screened=True)
    counts = seen.counts or _counted(seen)
    place, time, channel = _wrong_places(seen), _wrong_times(seen), _wrong_channels(seen)
    averages = _wrong_averages(seen)
    wrong = (place | time | averages)[:, None] | channel
    is_finite = np.isfinite(seen.stokes_i) & np.isfinite(seen.weights)
    has_weight = is_finite & (seen.weights > 0) & ~wrong
    heavy = has_weight & _dwarfs_others(seen.weights, has_weight)
    with np.errstate(all="ignore"):
        power = np.abs(seen.stokes_i) ** 2 * seen.weights
        huge = has_weight & ~heavy & ~(power < LARGEST_SNR**2)
    unusable = wrong | heavy | huge | ~is_finite | (seen.weights < 0)
    if not unusable.any():
        return replace(seen, counts=counts)
    counted = seen.weights > 0
    lost = {
        "impossible_uvw": counted & place[:, None],
        "impossible_times": counted & (time & ~place)[:, None],
        "impossible_channels": counted & ~(place | time)[:, None] & channel,
        "impossible_averages": counted & (averages & ~(place | time))[:, None] & ~channel,
        "impossible_weights": heavy,
        "impossible_amplitudes": huge,
    }
    found = {name: int(np.count_nonzero(samples)) for name, samples in lost.items()}
    weights = np.where(unusable, 0, seen.weights).astype(seen.weights.dtype)
    return replace(
        _with_harmless_channels(seen, channel),
        uvw=np.where(place[:, None], 0.0, seen.uvw),
        stokes_i=np.where(unusable, 0, seen.stokes_i).astype(seen.stokes_i.dtype),
        weights=weights,
        integrations=_without_wrong_times(seen, time),
        averages=_without_wrong_averages(seen, averages),
        counts=replace(counts, usable=int(np.count_nonzero(weights)), **found),
    )


def screened_chunks(observation: Observation) -> Iterator[Visibilities]:
    """Read everything once, without the samples that cannot be right."""
    return map(screened, observation.chunks())


def _wrong_places(seen: Visibilities) -> Bool[Array, " row"]:
    antennas = None if seen.integrations is None else seen.integrations.antennas
    return ~seen.array.allows(seen.uvw, antennas)


def _wrong_channels(seen: Visibilities) -> Bool[Array, " chan"]:
    lowest, highest = RADIO_FREQUENCIES
    wrong = ~((seen.frequency >= lowest) & (seen.frequency <= highest))
    if seen.width is not None:
        wrong |= ~((seen.width >= 0) & (seen.width <= highest))
    return wrong


def _with_harmless_channels(seen: Visibilities, wrong: Bool[Array, " chan"]) -> Visibilities:
    if not wrong.any():
        return seen
    right = seen.frequency[~wrong]
    usual = right[0] if len(right) else RADIO_FREQUENCIES[0]
    return replace(
        seen,
        frequency=np.where(wrong, usual, seen.frequency),
        width=None if seen.width is None else np.where(wrong, 0.0, seen.width),
    )


def _dwarfs_others(
    weights: Float[Array, "row chan"], has_weight: Bool[Array, "row chan"]
) -> Bool[Array, "row chan"]:
    usual = weights[has_weight]
    if len(usual) == 0 or not usual.max() > LARGEST_WEIGHT * float(usual.min()):
        return np.zeros(weights.shape, bool)
    place = int(FEW * (len(usual) - 1))
    return weights > LARGEST_WEIGHT * float(np.partition(usual, place)[place])


def _wrong_times(seen: Visibilities) -> Bool[Array, " row"]:
    taken = seen.integrations
    if taken is None:
        return np.zeros(len(seen), bool)
    is_possible = (taken.interval >= 0) & (taken.interval <= LONGEST_INTEGRATION)
    return ~(np.isfinite(taken.time) & is_possible)


def _without_wrong_times(seen: Visibilities, wrong: Bool[Array, " row"]) -> Integrations | None:
    taken = seen.integrations
    if taken is None or not wrong.any():
        return taken
    return replace(
        taken,
        time=np.where(wrong, NO_TIME, taken.time),
        interval=np.where(wrong, 0.0, taken.interval),
    )


def _wrong_averages(seen: Visibilities) -> Bool[Array, " row"]:
    if seen.averages is None:
        return np.zeros(len(seen), bool)
    return ~seen.averages.are_possible(float(seen.frequency[0]))


def _without_wrong_averages(seen: Visibilities, wrong: Bool[Array, " row"]) -> AveragedRows | None:
    if seen.averages is None or not wrong.any():
        return seen.averages
    return seen.averages.with_harmless(wrong, float(seen.frequency[0]))


def _counted(seen: Visibilities) -> SampleCounts:
    """Count the samples of a block whose reader has not done so."""
    is_finite = np.isfinite(seen.weights)
    is_finite &= np.isfinite(seen.stokes_i) | (seen.weights == 0)
    return SampleCounts(
        rows=len(seen),
        samples=seen.weights.size,
        usable=int(np.count_nonzero(is_finite & (seen.weights > 0))),
        flagged=int(np.count_nonzero(seen.weights == 0)),
        non_finite=int(np.count_nonzero(~is_finite)),
        non_positive_weights=int(np.count_nonzero(is_finite & (seen.weights < 0))),
    )
