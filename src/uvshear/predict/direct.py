"""Visibilities of galaxies by direct summation over the galaxies.

The w term across a galaxy is taken to first order (``predict_visibilities``); there is no other approximation besides
rounding.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Exponential, Galaxies, Profile
from uvshear.geometry.directions import n_minus_one
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.interferometer.attenuation import AttenuatedSamples
from uvshear.predict import kernels
from uvshear.predict.losses import Losses
from uvshear.progress import Meter, Progress
from uvshear.typing import Array, Complex, Float

SLAB, SOURCES = 16384, 16
"""Number of rows in a slab, and of sources whose envelopes are evaluated at a time. With fewer rows the interpreter
would take more of the time. The kernels themselves go through the rows in blocks."""

ROUNDING, MEAN_ROUNDING = 3e-7, 1e-8
"""Upper limits of the rms and of the mean rounding error of a galaxy's visibilities in single precision, divided by its
flux. The measured values are less than half of them."""


def predict_visibilities(
    galaxies: Galaxies,
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    profile: Profile | None = None,
    executor: Executor = SERIAL,
    losses: Losses | None = None,
    dtype: type[np.floating] = np.float64,
    progress: Progress | None = None,
) -> Complex[Array, "row chan"]:
    r"""Sum the visibilities of all galaxies [Jy].

    .. math:: V = \sum_s S_s (\nu/\nu_\mathrm{ref})^{\beta_s}\, \tilde I_s(u - w l_s/n_s,\, v - w m_s/n_s)\,
              e^{2\pi i [u l_s + v m_s + w (n_s - 1)]}

    The shift of (u, v) in the envelope is the first-order expansion of w (n - 1) about the centre of the galaxy. The
    second-order term is w x^2/2 turns at a distance x [rad] from the centre: 6e-4 turns at 10 arcsec for w = 5e5
    wavelengths. Each slab of rows is summed over sources in the same order, so that results do not depend on the
    executor.

    Parameters
    ----------
    galaxies
        Galaxies of the sky, with l^2 + m^2 < 1.
    uvw
        Baselines [m].
    frequency
        Channel centres [Hz].
    profile
        Brightness profile of all galaxies; exponential unless given.
    executor
        Executor for the slabs of rows.
    losses
        Losses by averaging and primary beams, which are evaluated at the centre of each galaxy; none unless given.
    dtype
        Precision of each galaxy's visibilities. With float32 the rms rounding error is below 3e-7 of the galaxy's flux,
        and the sum takes little more than half the time. Phases (in turns) and sums over galaxies are float64 in any
        case.
    progress
        Function that is called with the number of visibilities that are done and the number of all.

    References
    ----------
    Rivi & Miller 2018, MNRAS 476, 2053, eq. 1 (there without w) and 5.
    """
    sky, shape = _Sky(galaxies, frequency), profile or Exponential()
    add = kernels.add_sources_single if dtype is np.float32 else kernels.add_sources

    def predict(rows: slice, chan: int, block: Float[Array, "3 row"]) -> Complex[Array, " row"]:
        factor: _Factor | None = None
        if losses is not None:
            samples = losses.samples(uvw, frequency, rows, chan)
            factor = _Attenuated(losses.attenuation.over(samples), galaxies)
        return _predict_slab(sky, block, chan, shape, _Summation(add, dtype), factor)

    return _over_slabs(predict, uvw, len(frequency), executor, progress)


def predict_multiples(
    galaxies: Galaxies,
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    profile: Profile,
    unit: float,
    executor: Executor = SERIAL,
) -> Complex[Array, "row chan"]:
    """Sum the visibilities of all galaxies, each rounded to the nearest integer multiple of a unit, in this unit.

    As long as these sums of integers are below 2^53 they are exact. The order of the galaxies does not matter then, and
    a galaxy can be taken out again by adding it with the opposite flux.

    Parameters
    ----------
    galaxies, uvw, frequency, profile, executor
        As for ``predict_visibilities``.
    unit
        The unit [Jy], a power of two.
    """
    sky = _Sky(galaxies, frequency)
    summation = _Summation(partial(kernels.add_rounded_sources, 1 / unit), np.float64)

    def predict(_: slice, chan: int, block: Float[Array, "3 row"]) -> Complex[Array, " row"]:
        return _predict_slab(sky, block, chan, profile, summation)

    return _over_slabs(predict, uvw, len(frequency), executor)


def _over_slabs(
    predict: Callable[[slice, int, Float[Array, "3 row"]], Complex[Array, " row"]],
    uvw: Float[Array, "row 3"],
    channels: int,
    executor: Executor,
    progress: Progress | None = None,
) -> Complex[Array, "row chan"]:
    """Call a function for the rows of each slab, the number of each channel, and the baselines of the slab."""
    vis = np.empty((len(uvw), channels), complex)

    def fill(task: tuple[int, int]) -> int:
        start, chan = task
        rows = slice(start, start + SLAB)
        block = np.ascontiguousarray(uvw[rows].T, float)
        vis[rows, chan] = predict(rows, chan, block)
        return block.shape[1]

    meter = Meter(progress)
    meter.expect(vis.size)
    for done in executor.map(fill, product(range(0, len(uvw), SLAB), range(channels))):
        meter.add(done)
    return vis


def largest_flux(galaxies: Galaxies, frequency: Float[Array, " chan"]) -> Float[Array, " source"]:
    """Return the largest flux of each galaxy in a band [Jy]."""
    edges = np.array([[frequency.min()], [frequency.max()]]) / galaxies.reference_frequency
    return np.abs(galaxies.flux) * (edges**galaxies.spectral_index).max(axis=0)


def precision_within(error: float, flux: Float[Array, " source"]) -> type[np.floating]:
    """Return single precision if rounding then adds an rms error of less than a third of ``error`` [Jy].

    ``flux`` is that of the galaxies that are summed [Jy]. Otherwise the function returns double precision.
    """
    rounding = ROUNDING * math.sqrt(float(np.sum(flux**2))) + MEAN_ROUNDING * float(np.sum(flux))
    return np.float32 if rounding < error / 3 else np.float64


_Factor = Callable[[slice, Float[Array, "source row"]], None]
"""Function that multiplies the rows of an array by the factors of sources, given their indices, at each sample."""


@dataclass(frozen=True)
class _Attenuated:
    attenuated: AttenuatedSamples
    galaxies: Galaxies

    def __call__(self, sources: slice, factors: Float[Array, "source row"]) -> None:
        self.attenuated.multiply(factors, self.galaxies.l[sources], self.galaxies.m[sources])


class _Sky:
    """The galaxies as arrays for the kernels."""

    def __init__(self, galaxies: Galaxies, frequency: Float[Array, " chan"]) -> None:
        l, m = galaxies.l, galaxies.m
        n1 = n_minus_one(l, m)
        self.lmn1 = np.stack([l, m, n1], axis=-1)
        self.slopes = np.stack([l, m], axis=-1) / (1 + n1)[:, None]
        self.forms = np.stack(quadratic_form(galaxies.ellipticity, galaxies.scale_length), axis=-1)
        ratio = frequency[None, :] / galaxies.reference_frequency
        self.flux = galaxies.flux[:, None] * ratio ** galaxies.spectral_index[:, None]
        self.per_metre = frequency / SPEED_OF_LIGHT


def sum_of_sources(
    galaxies: Galaxies,
    uvw: Float[Array, "sample 3"],
    profile: Profile,
    factor: _Factor,
) -> Complex[Array, " sample"]:
    """Sum the visibilities of all galaxies [Jy] at baselines in wavelengths.

    Parameters
    ----------
    factor
        Function that multiplies the rows of an array by the factors of sources, given their indices, at each sample:
        their spectra, and attenuation if there is any.
    """
    flat = replace(galaxies, spectral_index=np.zeros(len(galaxies)))
    sky, block = _Sky(flat, np.array([SPEED_OF_LIGHT])), np.ascontiguousarray(uvw.T, float)
    summation = _Summation(kernels.add_sources, np.float64)
    return _predict_slab(sky, block, 0, profile, summation, factor)


@dataclass(frozen=True)
class _Summation:
    """Kernel that adds sources, and the precision of their envelopes."""

    add: Callable[..., None]
    dtype: type[np.floating]


def _predict_slab(
    sky: _Sky,
    uvw: Float[Array, "3 row"],
    chan: int,
    profile: Profile,
    summation: _Summation,
    factor: _Factor | None = None,
) -> Complex[Array, " row"]:
    rows = uvw.shape[1]
    real, imaginary = np.zeros((2, rows))
    arguments = np.empty((SOURCES, rows), summation.dtype)
    baselines, per_metre = uvw.astype(summation.dtype, copy=False), sky.per_metre[chan]
    for first in range(0, len(sky.lmn1), SOURCES):
        batch = slice(first, first + SOURCES)
        forms = sky.forms[batch]
        q = arguments[: len(forms)]
        kernels.profile_arguments(baselines, per_metre, sky.slopes[batch], forms, q)
        amplitude = profile.envelope(q)
        if factor is not None:
            amplitude = np.array(amplitude)
            factor(batch, amplitude)
        flux = sky.flux[batch, chan]
        summation.add(uvw, per_metre, sky.lmn1[batch], flux, amplitude, real, imaginary)
    return real + 1j * imaginary
