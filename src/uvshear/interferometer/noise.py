"""Thermal noise of the correlations, from the sensitivity of the dishes or as a given number."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np

from uvshear.errors import InputError
from uvshear.interferometer.coverage import Coverage
from uvshear.interferometer.spectral_window import Channels
from uvshear.typing import Array, Float

Sefd: TypeAlias = float | tuple[tuple[float, float], ...]
"""System equivalent flux density of any dish [Jy], or pairs (diameter [m], SEFD [Jy])."""


class Noise(ABC):
    """Independent Gaussian noise in the real and the imaginary part of every correlation."""

    @abstractmethod
    def correlation_sigma(self, coverage: Coverage, channels: Channels) -> Float[Array, "row chan"]:
        """Return the standard deviation of ONE real component of one correlation, for example XX [Jy]."""


@dataclass(frozen=True)
class RadiometerNoise(Noise):
    """Noise from the sensitivity of the dishes; subclasses say whether it is that of a correlation or of Stokes I.

    Parameters
    ----------
    sefd
        System equivalent flux density of a dish, or of each kind of dish by diameter.
    efficiency
        Efficiency eta of the system, 0 to 1.
    """

    sefd: Sefd
    efficiency: float = 0.9

    def __post_init__(self) -> None:
        _check(self.sefd, self.efficiency)


@final
@dataclass(frozen=True)
class CorrelationNoise(RadiometerNoise):
    """Noise whose :func:`radiometer_sigma` applies to each correlation, as it does in the radiometer equation.

    Stokes I then has sigma / sqrt(2), and signal-to-noise ratios are higher by sqrt(2) than with :class:`StokesINoise`.
    """

    def correlation_sigma(self, coverage: Coverage, channels: Channels) -> Float[Array, "row chan"]:
        """Sigma of the radiometer equation."""
        return radiometer_sigma(self.sefd, self.efficiency, coverage, channels)


@final
@dataclass(frozen=True)
class StokesINoise(RadiometerNoise):
    """Noise whose :func:`radiometer_sigma` applies to Stokes I: Rivi & Miller 2018, section 3.

    Each correlation then has sqrt(2) sigma.
    """

    def correlation_sigma(self, coverage: Coverage, channels: Channels) -> Float[Array, "row chan"]:
        """Sqrt(2) times sigma of the radiometer equation."""
        return math.sqrt(2) * radiometer_sigma(self.sefd, self.efficiency, coverage, channels)


@final
@dataclass(frozen=True)
class ScaledNoise(Noise):
    """The same noise everywhere, given for Stokes I.

    Parameters
    ----------
    stokes_i_sigma
        Standard deviation of one real component of Stokes I = (p + q)/2 [Jy].
    """

    stokes_i_sigma: float

    def __post_init__(self) -> None:
        if not 0 < self.stokes_i_sigma < math.inf:
            raise InputError(f"the noise is {self.stokes_i_sigma:g} Jy; it must be positive")

    def correlation_sigma(self, coverage: Coverage, channels: Channels) -> Float[Array, "row chan"]:
        """Sqrt(2) times that of Stokes I."""
        return np.full((len(coverage), len(channels)), math.sqrt(2) * self.stokes_i_sigma)


def radiometer_sigma(
    sefd: Sefd, efficiency: float, coverage: Coverage, channels: Channels
) -> Float[Array, "row chan"]:
    r"""Noise of a baseline between dishes p and q [Jy].

    .. math:: \sigma = \sqrt{\mathrm{SEFD}_p\,\mathrm{SEFD}_q} / (\eta\sqrt{2\,\Delta\nu\,\Delta t})

    References
    ----------
    Rivi & Miller 2018, MNRAS 476, 2053, section 3, for equal dishes.
    """
    root_sefd = np.sqrt(_sefd_of_antennas(sefd, coverage))
    baseline = root_sefd[coverage.antenna1] * root_sefd[coverage.antenna2] / efficiency
    return baseline[:, None] / np.sqrt(2 * channels.width * coverage.integration)


def _sefd_of_antennas(sefd: Sefd, coverage: Coverage) -> Float[Array, " antenna"]:
    diameters = coverage.layout.diameters
    if not isinstance(sefd, tuple):
        return np.full(len(diameters), float(sefd))
    values = np.full(len(diameters), np.nan)
    for diameter, value in sefd:
        values[np.isclose(diameters, diameter)] = value
    if np.isnan(values).any():
        missing = sorted({f"{diameter:g}" for diameter in diameters[np.isnan(values)]})
        raise InputError(
            f"layout {coverage.layout.name} has dishes of {', '.join(missing)} m without an SEFD;"
            " give an SEFD for each diameter, or one for all"
        )
    return values


def _check(sefd: Sefd, efficiency: float) -> None:
    values = [value for _, value in sefd] if isinstance(sefd, tuple) else [sefd]
    if not all(0 < value < math.inf for value in values):
        raise InputError(f"an SEFD of {sefd} Jy; it must be positive")
    if not 0 < efficiency <= 1:
        raise InputError(f"an efficiency of {efficiency:g}; it must be above 0 and at most 1")
