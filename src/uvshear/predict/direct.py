"""Visibilities of galaxies by the exact sum over sources."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Exponential, Galaxies, Profile
from uvshear.geometry.directions import n_minus_one
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.samples import Samples
from uvshear.predict import kernels
from uvshear.predict.losses import Losses
from uvshear.typing import Array, Complex, Float

SLAB = 32768
"""Number of rows in a slab. With fewer, the interpreter between kernels costs more time than the caches save, and a
second worker gains nothing."""


def predict_visibilities(
    galaxies: Galaxies,
    uvw: Float[Array, "row 3"],
    frequency: Float[Array, " chan"],
    profile: Profile | None = None,
    executor: Executor = SERIAL,
    losses: Losses | None = None,
) -> Complex[Array, "row chan"]:
    r"""Sum the visibilities of all galaxies [Jy].

    .. math:: V = \sum_s S_s (\nu/\nu_\mathrm{ref})^{\beta_s}\, \tilde I_s(u - w l_s/n_s,\, v - w m_s/n_s)\,
              e^{2\pi i [u l_s + v m_s + w (n_s - 1)]}

    The shift of (u, v) in the envelope is the first-order expansion of w (n - 1) about the centre of the galaxy. The
    second-order term is w x^2/2 turns at a distance x, which is 6e-4 at 10 arcsec for w = 5e5 wavelengths. Each slab of
    rows is summed over sources in the same order, so that results do not depend on the executor.

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

    References
    ----------
    Rivi & Miller 2018, MNRAS 476, 2053, eq. 1 (there without w) and 5.
    """
    profile = profile or Exponential()
    vis = np.empty((len(uvw), len(frequency)), complex)
    sky = _Sky(galaxies, frequency)

    def fill(start: int) -> None:
        rows = slice(start, start + SLAB)
        block = np.ascontiguousarray(uvw[rows].T, float)
        for chan in range(len(frequency)):
            factor = None
            if losses is not None:
                samples = losses.samples(uvw, frequency, rows, chan)
                factor = partial(_attenuation, losses.attenuation, samples, galaxies)
            vis[rows, chan] = _predict_slab(sky, block, chan, profile, factor)

    for _ in executor.map(fill, range(0, len(uvw), SLAB)):
        pass
    return vis


def _attenuation(
    attenuation: Attenuation, samples: Samples, galaxies: Galaxies, source: int
) -> Float[Array, " sample"]:
    return attenuation.factor(samples, float(galaxies.l[source]), float(galaxies.m[source]))


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
    factor: Callable[[int], Float[Array, " sample"]],
) -> Complex[Array, " sample"]:
    """Sum the visibilities of all galaxies [Jy] at baselines in wavelengths.

    Parameters
    ----------
    factor
        Function that returns the factor of each sample for a source, given its index: its spectrum, and attenuation if
        there is any.
    """
    flat = replace(galaxies, spectral_index=np.zeros(len(galaxies)))
    sky = _Sky(flat, np.array([SPEED_OF_LIGHT]))
    return _predict_slab(sky, np.ascontiguousarray(uvw.T, float), 0, profile, factor)


def _predict_slab(
    sky: _Sky,
    uvw: Float[Array, "3 row"],
    chan: int,
    profile: Profile,
    factor: Callable[[int], Float[Array, " row"]] | None,
) -> Complex[Array, " row"]:
    real, imaginary, q = np.zeros((3, uvw.shape[1]))
    per_metre = sky.per_metre[chan]
    for source in range(len(sky.lmn1)):
        slope_l, slope_m = sky.slopes[source]
        kernels.profile_argument(uvw, per_metre, slope_l, slope_m, sky.forms[source], q)
        envelope = profile.envelope(q)
        if factor is not None:
            envelope = envelope * factor(source)
        flux = sky.flux[source, chan]
        kernels.add_source(uvw, per_metre, sky.lmn1[source], flux, envelope, real, imaginary)
    return real + 1j * imaginary
