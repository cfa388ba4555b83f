"""Stokes I visibilities with their weights, the data of every measurement."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Protocol, Self, runtime_checkable

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.array_extent import ArrayExtent
from uvshear.interferometer.averaged_rows import AveragedRows
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.typing import Array, Bool, Complex, Float, Int


@dataclass(frozen=True)
class Integrations:
    """Antennas and integration of each row of a block.

    Parameters
    ----------
    antennas
        Numbers of ANTENNA1 and ANTENNA2.
    time
        Middle of the integration [s], counted from any epoch.
    interval
        Length of the integration [s]; 0 where nothing was averaged.
    """

    antennas: Int[Array, "row 2"]
    time: Float[Array, " row"]
    interval: Float[Array, " row"]

    def select(self, chosen: Bool[Array, " row"] | slice) -> Self:
        """Return the chosen rows."""
        return type(self)(self.antennas[chosen], self.time[chosen], self.interval[chosen])


@dataclass(frozen=True)
class Visibilities:
    """A block of rows that share their channels.

    Parameters
    ----------
    uvw
        Baselines X(ANTENNA1) - X(ANTENNA2) [m].
    frequency
        Channel centres [Hz].
    stokes_i
        DATA = sum S exp(+2 pi i (u l + v m + w (n-1))) [Jy]. Finite wherever the weight is positive.
    weights
        1/sigma^2, with sigma the standard deviation of one real component [Jy^-2]; 0 marks flagged samples.
    width
        Band that each channel was averaged over [Hz]; None where nothing was averaged.
    integrations
        Integration of each row; None where it is not known.
    counts
        Numbers of samples of the block that were used and that were left out, by reason; None where the reader has not
        counted.
    hand_powers
        Power of the difference of the two parallel hands over its variance (``stokes.powers_of_hands``), at some
        samples of the block; None where it is not known.
    array
        Lengths that the baselines of the array can have.
    averages
        What is known of the samples that each row is an average of (``uvshear average``); None if the rows are samples.
    is_screened
        Whether samples that cannot be right have been left out (``screening``).
    """

    uvw: Float[Array, "row 3"]
    frequency: Float[Array, " chan"]
    stokes_i: Complex[Array, "row chan"]
    weights: Float[Array, "row chan"]
    width: Float[Array, " chan"] | None = None
    integrations: Integrations | None = None
    counts: SampleCounts | None = None
    hand_powers: Float[Array, " drawn"] | None = None
    array: ArrayExtent = field(default_factory=ArrayExtent)
    averages: AveragedRows | None = None
    is_screened: bool = False

    def __len__(self) -> int:
        return len(self.uvw)

    def of_rows(self, rows: slice) -> Self:
        """Return some rows; what is known of the block as a whole is left out."""
        integrations = None if self.integrations is None else self.integrations.select(rows)
        return replace(
            self,
            uvw=self.uvw[rows],
            stokes_i=self.stokes_i[rows],
            weights=self.weights[rows],
            integrations=integrations,
            averages=None if self.averages is None else self.averages.select(rows),
            counts=None,
            hand_powers=None,
        )

    def with_stokes_i(self, stokes_i: Complex[Array, "row chan"]) -> Self:
        """Return the same samples with other visibilities, whose two hands are not known."""
        return replace(self, stokes_i=stokes_i, hand_powers=None)

    @property
    def uv_distance(self) -> Float[Array, "row chan"]:
        """Length of the projected baseline [wavelengths]."""
        metres = np.hypot(self.uvw[:, 0], self.uvw[:, 1])
        return metres[:, None] * (self.frequency / SPEED_OF_LIGHT)


@runtime_checkable
class Observation(Protocol):
    """Visibilities of one pointing, read in chunks as often as needed: in memory, or from a file.

    A reader of a file format returns an object with these two members. Optional properties of observations are found
    through ``interferometer.origin`` and ``interferometer.dishes``.
    """

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        ...

    def chunks(self) -> Iterator[Visibilities]:
        """Read everything once, a block of rows at a time."""
        ...


@dataclass(frozen=True)
class VisibilitySet:
    """An observation held in memory."""

    phase_centre: PhaseCentre
    blocks: tuple[Visibilities, ...]

    def chunks(self) -> Iterator[Visibilities]:
        """Yield the blocks."""
        yield from self.blocks

    def expected_samples(self) -> float:
        """Return the number of samples."""
        return sum(block.stokes_i.size for block in self.blocks)
