"""Visibilities without rows and channels: one element for each sample, with baselines in wavelengths."""

from dataclasses import dataclass, field
from typing import Self

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.execution import Executor
from uvshear.interferometer.visibilities import Visibilities
from uvshear.typing import Array, Bool, Complex, Float, Int, Shaped

_AT_A_TIME = 2**19
"""Number of samples that a worker gathers at a time."""


@dataclass(frozen=True)
class Samples:
    """Samples of the uv plane that carry weight.

    Parameters
    ----------
    uvw
        Baselines [wavelengths].
    stokes_i
        Visibilities [Jy].
    weights
        1/sigma^2 [Jy^-2].
    frequency
        Frequency of each sample [Hz].
    bandwidth
        Band that the sample was averaged over [Hz]; 0 where nothing was averaged.
    interval
        Time that the sample was averaged over [s]; 0 where nothing was averaged.
    antennas
        Numbers of ANTENNA1 and ANTENNA2; -1 where they are not known.
    scatter
        Coefficients of second and then of fourth degree (``AveragedRows``) of the baselines of which each sample is an
        average [wavelengths^2, wavelengths^4]; no columns where samples are no such averages.
    """

    uvw: Float[Array, "sample 3"]
    stokes_i: Complex[Array, " sample"]
    weights: Float[Array, " sample"]
    frequency: Float[Array, " sample"]
    bandwidth: Float[Array, " sample"]
    interval: Float[Array, " sample"]
    antennas: Int[Array, "sample 2"]
    scatter: Float[Array, "covered moment"] = field(
        default_factory=lambda: np.zeros((0, 0), np.float32)
    )

    def __post_init__(self) -> None:
        if len(self.scatter) != len(self.uvw):
            object.__setattr__(self, "scatter", np.zeros((len(self.uvw), 0), np.float32))

    def __len__(self) -> int:
        return len(self.uvw)

    @classmethod
    def from_visibilities(cls, visibilities: Visibilities, shortest: float, longest: float) -> Self:
        """Select the samples with weight whose uv distance [wavelengths] is in [shortest, longest)."""
        distance = visibilities.uv_distance
        taken = (visibilities.weights > 0) & (distance >= shortest) & (distance < longest)
        return cls.at(visibilities, *np.nonzero(taken))

    @classmethod
    def at(
        cls, visibilities: Visibilities, row: Int[Array, " sample"], chan: Int[Array, " sample"]
    ) -> Self:
        """Take the samples at these rows and channels."""
        in_wavelengths = visibilities.frequency[chan] / SPEED_OF_LIGHT
        integrations, averages = visibilities.integrations, visibilities.averages
        nothing = np.zeros(len(row), np.float32)
        if averages is None:
            frequency = visibilities.frequency[chan]
            width = nothing if visibilities.width is None else visibilities.width[chan]
            scatter = nothing[:, None][:, :0]
        else:
            frequency, width = averages.frequency[row], averages.width[row]
            second, fourth = averages.second[row], averages.fourth[row]
            square = (in_wavelengths**2)[:, None]
            scatter = np.concatenate([second * square, fourth * square**2], axis=1)
        return cls(
            uvw=visibilities.uvw[row] * in_wavelengths[:, None],
            stokes_i=visibilities.stokes_i[row, chan].astype(np.complex64, copy=False),
            weights=visibilities.weights[row, chan].astype(np.float32, copy=False),
            frequency=frequency.astype(float, copy=False),
            bandwidth=width.astype(np.float32, copy=False),
            interval=(
                nothing if integrations is None else integrations.interval[row].astype(np.float32)
            ),
            antennas=(
                np.full((len(row), 2), -1, np.int16)
                if integrations is None
                else integrations.antennas[row].astype(np.int16)
            ),
            scatter=scatter.astype(np.float32, copy=False),
        )

    @classmethod
    def join(cls, parts: list[Self]) -> Self:
        """Join parts one after the other."""
        return cls(
            *(
                np.concatenate([getattr(part, name) for part in parts])
                for name in cls.__dataclass_fields__
            )
        )

    def select(self, chosen: Bool[Array, " sample"] | Shaped[Array, " chosen"] | slice) -> Self:
        """Return the chosen samples (any one-dimensional numpy index)."""
        return type(self)(
            *(getattr(self, name)[chosen] for name in type(self).__dataclass_fields__)
        )

    def taken(self, numbers: Int[Array, " chosen"], executor: Executor) -> Self:
        """Return the samples of these numbers, gathered by the workers of an executor."""
        arrays = [getattr(self, name) for name in type(self).__dataclass_fields__]
        taken = [np.empty((len(numbers), *array.shape[1:]), array.dtype) for array in arrays]

        def gather(task: tuple[int, int]) -> None:
            array, first = task
            rows = slice(first, first + _AT_A_TIME)
            # With other modes the output would be buffered; all numbers are valid.
            np.take(arrays[array], numbers[rows], axis=0, out=taken[array][rows], mode="clip")

        starts = range(0, len(numbers), _AT_A_TIME)
        tasks = [(array, first) for array in range(len(arrays)) for first in starts]
        for _ in executor.map(gather, tasks):
            pass
        return type(self)(*taken)

    @property
    def uv_distance(self) -> Float[Array, " sample"]:
        """Length of the projected baseline [wavelengths]."""
        return np.hypot(self.uvw[:, 0], self.uvw[:, 1])
