"""The bias of an estimator of the shear, and the simulation that gave it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from uvshear.estimators.shear_estimate import SKY, ShearConditions
from uvshear.estimators.with_error import with_error
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class BiasSimulation:
    """The simulation of a bias.

    Parameters
    ----------
    conditions
        Estimator, lower cuts and facets. The cut ``snr_min`` applies to the signal-to-noise ratio of the catalogue's
        flux and the median size, unless ``cuts_on_measured``.
    cuts_on_measured
        Whether ``snr_min`` was a cut on the fitted signal-to-noise ratio.
    flux_max
        Catalogue's flux above which galaxies were left out [Jy].
    keeps_scale_lengths
        Whether the simulated shear changed ellipticities alone, as in the paper.
    position_sigma
        Standard error of the catalogue's positions in l and in m [rad].
    shears
        Shears that were applied, in the frame of the sky.
    density
        Number of galaxies per square arcminute of a crowded field; None for isolated galaxies.
    seed
        Seed of galaxies and noise; None if it is not known.
    """

    conditions: ShearConditions
    cuts_on_measured: bool = False
    flux_max: float = math.inf
    keeps_scale_lengths: bool = False
    position_sigma: float = 0.0
    shears: tuple[complex, ...] = ()
    density: float | None = None
    seed: int | None = None


@dataclass(frozen=True)
class Bias:
    """Bias of an estimator: g measured = (1 + m) g + c, component by component, with jackknife errors.

    Parameters
    ----------
    name
        Name of the galaxies: "all", or their bin of flux.
    m, m_err, c, c_err
        Multiplicative and additive bias of both components; m is NaN where no shear was applied.
    response
        Response of the estimator's terms to both components, summed over the measurements of a galaxy and averaged over
        galaxies; its product with the number of galaxies is the weight of a bin when biases are averaged over bins.
    n
        Number of galaxies, each measured several times.
    failed
        Number of measurements that failed and are left out.
    bins
        Bias of the galaxies of each bin of flux.
    frame
        Frame of the components; "sky" is that of local North.
    simulation
        The simulation; None for a bias that has not been attached to one, and for bins.
    """

    name: str
    m: Float[Array, " 2"]
    m_err: Float[Array, " 2"]
    c: Float[Array, " 2"]
    c_err: Float[Array, " 2"]
    response: Float[Array, " 2"]
    n: int
    failed: int = 0
    bins: tuple["Bias", ...] = field(default=(), repr=False)
    frame: str = SKY
    simulation: BiasSimulation | None = field(default=None, repr=False)

    def record(self) -> dict[str, float | int]:
        """Return the finite numbers by name, without those of the bins."""
        numbers = {
            f"{name}{i + 1}{suffix}": float(value[i])
            for name, best, error in (("m", self.m, self.m_err), ("c", self.c, self.c_err))
            for i in (0, 1)
            for suffix, value in (("", best), ("_err", error))
        }
        numbers |= {f"response{i + 1}": float(self.response[i]) for i in (0, 1)}
        finite = {name: value for name, value in numbers.items() if np.isfinite(value)}
        return finite | {"n": self.n, "failed": self.failed}

    @property
    def by_flux(self) -> Mapping[str, "Bias"]:
        """Biases of the bins of flux, by the names of the bins."""
        return {part.name: part for part in self.bins}

    def __str__(self) -> str:
        parts = [
            f"{name}{i + 1} = {with_error(value[i], error[i])}"
            for name, value, error in (("m", self.m, self.m_err), ("c", self.c, self.c_err))
            for i in (0, 1)
            if np.isfinite(value[i])
        ]
        failures = f", {self.failed} measurements failed" if self.failed else ""
        return f"{self.name}: {', '.join(parts)} ({self.n} galaxies{failures})"
