"""Channels and correlations of an MSv4 partition."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from uvshear.constants import RADIO_FREQUENCIES
from uvshear.errors import InputError
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.stokes import CORRELATION_NAMES, STOKES_I, parallel_hands
from uvshear.io.msv4.opening import Dataset, zarr_errors
from uvshear.io.msv4.variables import numbers, quantity, texts, unit_of
from uvshear.io.spectral_oddities import spectral_oddities
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class SpectralSetup:
    """Layout of the correlations of a partition.

    Parameters
    ----------
    channels
        Channels of the spectral window.
    averaged
        Band that each channel was averaged over [Hz]; 0 where nothing was averaged.
    correlations
        Names of the correlations.
    hands
        Indices of the correlations that make Stokes I.
    """

    channels: Channels
    averaged: Float[Array, " chan"]
    correlations: tuple[str, ...]
    hands: tuple[int, ...]

    @property
    def only_hand(self) -> str | None:
        """Name of the correlation that alone is taken as Stokes I; None where two are, or where it is Stokes I."""
        name = self.correlations[self.hands[0]]
        return None if len(self.hands) > 1 or name == CORRELATION_NAMES[STOKES_I] else name

    @property
    def oddities(self) -> tuple[str, ...]:
        """Facts that a user should know."""
        return spectral_oddities(self.channels, self.averaged, self.only_hand)

    @property
    def is_averaged(self) -> bool:
        """Whether the channels are averages over a band."""
        return bool(np.any(self.averaged > 0))


def read_setup(place: Path, partition: Dataset, *, is_sampled: bool) -> SpectralSetup:
    """Read the layout of a partition.

    Parameters
    ----------
    place
        Path of the partition.
    partition
        The partition.
    is_sampled
        Whether its visibilities are samples, not averages; this matters only without EFFECTIVE_CHANNEL_WIDTH.
    """
    frequency = numbers(place, partition, "frequency", ("frequency",))
    unit = unit_of(partition["frequency"].attrs)
    if unit not in {"", "Hz"}:
        raise InputError(f"{place}: frequency is in {unit}; Hz is needed")
    width = _widths(place, partition, len(frequency))
    try:
        channels = Channels(frequency=frequency, width=width)
    except InputError as error:
        raise InputError(f"{place}: {error}") from None
    correlations = texts(place, partition, "polarization")
    averaged = _effective_width(place, partition)
    if averaged is None:
        averaged = np.zeros(len(channels)) if is_sampled else channels.width
    return SpectralSetup(channels, averaged, correlations, _hands(place, correlations))


def _widths(place: Path, partition: Dataset, count: int) -> Float[Array, " chan"]:
    """Return the attribute channel_width, or CHANNEL_WIDTH, with which xarray-ms describes channels of many widths."""
    found = quantity(partition["frequency"].attrs, "channel_width")
    if found is None and "CHANNEL_WIDTH" in partition.variables:
        found = numbers(place, partition, "CHANNEL_WIDTH", ("frequency",))
    if found is None:
        raise InputError(
            f"{place}: frequency has no attribute channel_width, and there is no variable CHANNEL_WIDTH; one of them"
            " is needed"
        )
    if len(found) not in {1, count}:
        raise InputError(
            f"{place}: there are {len(found)} channel widths and {count} frequencies; one width, or one for each"
            " channel, is needed"
        )
    return np.abs(np.broadcast_to(found, count))


def _hands(place: Path, correlations: tuple[str, ...]) -> tuple[int, ...]:
    codes = {name: code for code, name in CORRELATION_NAMES.items()}
    try:
        return parallel_hands([codes.get(name, 0) for name in correlations])
    except InputError:
        raise InputError(
            f"{place}: the correlations {', '.join(correlations)} do not give Stokes I; I, or at least one of XX and"
            " YY or of RR and LL, is needed"
        ) from None


def _effective_width(place: Path, partition: Dataset) -> Float[Array, " chan"] | None:
    """Return EFFECTIVE_CHANNEL_WIDTH at the first time; None where it is missing or impossible."""
    name = "EFFECTIVE_CHANNEL_WIDTH"
    if name not in partition.variables or "frequency" not in partition[name].dims:
        return None
    found = partition[name]
    if "time" in found.dims:
        found = found.isel(time=0)
    others = tuple(axis for axis, one in enumerate(found.dims) if one != "frequency")
    with zarr_errors(place, name), np.errstate(all="ignore"):
        values = np.abs(np.asarray(found.values, float))
        averaged = np.where(np.isfinite(values), values, 0.0).max(axis=others, initial=0.0)
    return averaged if bool((averaged <= RADIO_FREQUENCIES[1]).all()) else None
