"""Rows of correlations, as a reader finds them in a file: they are combined into Stokes I and counted."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Self

import numpy as np

from uvshear.errors import InputError
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.stokes import stokes_i
from uvshear.interferometer.visibilities import Integrations, Visibilities
from uvshear.typing import Array, Bool, Complex, Float

BYTES_PER_SAMPLE: Final = 32
"""Memory that a sample of one correlation takes while it is read and combined."""

BYTES_PER_ROW: Final = 64
"""Memory that a row takes in addition to its samples: UVW, antennas, identifiers."""


LONGEST_AUTOCORRELATION: Final = 1.0
"""Length of UVW above which a row is not one of a single antenna [m]."""


@dataclass(frozen=True)
class CorrelatedRows:
    """Rows of one spectral window with the correlations that make Stokes I, of which there are one or two.

    Parameters
    ----------
    uvw
        Baselines X(ANTENNA1) - X(ANTENNA2) [m].
    integrations
        Antennas and integration of each row; rows of one antenna are autocorrelations.
    correlations
        Visibilities [Jy].
    weights
        1/sigma^2, with sigma the standard deviation of one real component [Jy^-2].
    flags
        Whether a sample is bad.
    """

    uvw: Float[Array, "row 3"]
    integrations: Integrations
    correlations: Complex[Array, "row chan corr"]
    weights: Float[Array, "row chan corr"]
    flags: Bool[Array, "row chan corr"]

    def __len__(self) -> int:
        return len(self.uvw)

    def select(self, chosen: Bool[Array, " row"] | slice) -> Self:
        """Return the chosen rows."""
        return type(self)(
            self.uvw[chosen],
            self.integrations.select(chosen),
            self.correlations[chosen],
            self.weights[chosen],
            self.flags[chosen],
        )

    def combine(
        self, frequency: Float[Array, " chan"], averaged: Float[Array, " chan"]
    ) -> Visibilities:
        """Return Stokes I of the cross-correlations, with the numbers of samples that are not usable, by reason.

        Parameters
        ----------
        frequency
            Centres of the channels [Hz].
        averaged
            Band that each channel was averaged over [Hz]; 0 where nothing was averaged.
        """
        is_cross = self.integrations.antennas[:, 0] != self.integrations.antennas[:, 1]
        # Without autocorrelations the arrays are used as they are, without a copy.
        cross = self if is_cross.all() else self.select(is_cross)
        combined = stokes_i(cross.correlations, cross.weights, cross.flags)
        usable = int(np.count_nonzero(combined.weights))
        counts = SampleCounts(
            rows=len(cross),
            autocorrelations=len(self) - len(cross),
            autocorrelations_with_uvw=self._with_uvw(~is_cross),
            samples=combined.weights.size,
            usable=usable,
            flagged=combined.weights.size - usable - combined.non_finite - combined.non_positive,
            non_finite=combined.non_finite,
            non_positive_weights=combined.non_positive,
        )
        return Visibilities(
            uvw=cross.uvw,
            frequency=frequency,
            stokes_i=combined.visibilities,
            weights=combined.weights,
            width=averaged,
            integrations=cross.integrations,
            counts=counts,
            hand_powers=combined.hand_powers,
        )

    def _with_uvw(self, chosen: Bool[Array, " row"]) -> int:
        with np.errstate(invalid="ignore", over="ignore"):
            return int(
                np.count_nonzero(np.linalg.norm(self.uvw[chosen], axis=1) > LONGEST_AUTOCORRELATION)
            )


def hands_slice(hands: Sequence[int]) -> slice:
    """Return the slice that takes the correlations of Stokes I from all of them: unlike a list, it copies nothing."""
    first, last = min(hands), max(hands)
    return slice(first, last + 1, max(1, last - first))


def usable_chunks(
    path: Path, chunks: Iterable[Visibilities], scans: Sequence[int] | None
) -> Iterator[Visibilities]:
    """Yield the chunks that have rows, and refuse a field at its end if no visibility could be used."""
    total = SampleCounts()
    for seen in chunks:
        if seen.counts is not None:
            total += seen.counts
        if len(seen):
            yield seen
    check_usable(path, total, scans)


def check_usable(path: Path, counts: SampleCounts, scans: Sequence[int] | None) -> None:
    """Refuse a field of which no visibility can be used, and say why.

    Parameters
    ----------
    path
        Path of the file.
    counts
        Numbers of samples of everything that was read.
    scans
        Numbers of the scans that were chosen; None if all were read.
    """
    if counts.usable:
        return
    if not counts.rows:
        chosen = (
            "the field" if scans is None else f"scans {', '.join(map(str, scans))} of the field"
        )
        what = "only autocorrelations" if counts.autocorrelations else "no rows"
        raise InputError(
            f"{path}: there are {what} in {chosen}; baselines between antennas are needed"
        )
    if counts.flagged == counts.samples:
        raise InputError(f"{path}: all visibilities are flagged; there is nothing to measure")
    raise InputError(
        f"{path}: no visibility is usable: of {counts.samples} visibilities, {counts.flagged} are flagged,"
        f" {counts.non_finite} not finite, {counts.non_positive_weights} without positive weight"
    )
