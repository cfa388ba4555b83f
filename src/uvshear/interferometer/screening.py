"""Samples that cannot be right are left out of every pass, and counted by reason."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.visibilities import Integrations, Observation, Visibilities
from uvshear.typing import Array, Bool

LONGEST_BASELINE: Final = 1e9
"""Length beyond which a baseline cannot be real, if that of the array is not known [m]: more than twice the distance of
the Moon."""

LARGEST_SNR: Final = 1e8
"""Signal-to-noise ratio beyond which a single visibility cannot be real. Squares of larger ones overflow in single
precision."""


def screened(seen: Visibilities) -> Visibilities:
    """Return the samples with a weight of 0 where they cannot be right, and with the numbers of these by reason.

    Rows are left out whose UVW is not finite, zero (as writers store it for missing antennas) or longer than the array,
    or whose time or integration is negative or not finite. Samples are left out that are not finite, or impossibly
    large.
    """
    counts = seen.counts or _counted(seen)
    has_weight = seen.weights > 0
    place, time = _wrong_places(seen), _wrong_times(seen)
    nowhere, never = has_weight & place[:, None], has_weight & (time & ~place)[:, None]
    with np.errstate(all="ignore"):
        power = np.abs(seen.stokes_i) ** 2 * seen.weights
        is_finite = np.isfinite(seen.stokes_i) & np.isfinite(seen.weights)
        is_huge = is_finite & ~(power < LARGEST_SNR**2)
    is_huge &= has_weight & ~(place | time)[:, None]
    unusable = nowhere | never | is_huge | ~is_finite | (seen.weights < 0)
    if not (unusable.any() or place.any() or time.any()):
        return replace(seen, counts=counts)
    lost = {
        "impossible_uvw": nowhere,
        "impossible_times": never,
        "impossible_amplitudes": is_huge,
    }
    found = {name: int(np.count_nonzero(samples)) for name, samples in lost.items()}
    weights = np.where(unusable, 0, seen.weights).astype(seen.weights.dtype)
    data = np.where(unusable, 0, seen.stokes_i).astype(seen.stokes_i.dtype)
    uvw = np.where(place[:, None], 0.0, seen.uvw)
    usable = int(np.count_nonzero(weights))
    return replace(
        seen,
        uvw=uvw,
        stokes_i=data,
        weights=weights,
        integrations=_without_wrong_times(seen, time),
        counts=replace(counts, usable=usable, **found),
    )


def screened_chunks(observation: Observation) -> Iterator[Visibilities]:
    """Read everything once, without the samples that cannot be right."""
    return map(screened, observation.chunks())


def _wrong_places(seen: Visibilities) -> Bool[Array, " row"]:
    with np.errstate(all="ignore"):
        length = np.sqrt(np.sum(seen.uvw**2, axis=1))
    longest = LONGEST_BASELINE if seen.longest_baseline is None else seen.longest_baseline
    return ~((length > 0) & (length <= longest))


def _wrong_times(seen: Visibilities) -> Bool[Array, " row"]:
    taken = seen.integrations
    if taken is None:
        return np.zeros(len(seen), bool)
    return ~(np.isfinite(taken.time) & np.isfinite(taken.interval) & (taken.interval >= 0))


def _without_wrong_times(seen: Visibilities, wrong: Bool[Array, " row"]) -> Integrations | None:
    taken = seen.integrations
    if taken is None or not wrong.any():
        return taken
    return replace(
        taken,
        time=np.where(wrong, 0.0, taken.time),
        interval=np.where(wrong, 0.0, taken.interval),
    )


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
