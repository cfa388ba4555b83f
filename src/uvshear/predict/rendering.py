"""Galaxies drawn as pixels: the Fourier transform of the image is that of the galaxies on the baselines of a band."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import fft

from uvshear.galaxy import Galaxies, Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.imaging.bands import Band
from uvshear.imaging.tiles import Tile
from uvshear.numerics.fft_sizes import fast_size
from uvshear.numerics.real_transforms import images_of
from uvshear.predict import kernels
from uvshear.typing import Array, Complex, Float, Int

SMALLEST_STAMP = 40
"""Smallest size of a stamp [pixels]: where a galaxy is smaller than the pixels of a coarse band, the taper sets the
extent of its image."""

LARGEST_STAMP = 1536
"""Largest size of a stamp [pixels], however large a galaxy is listed or fitted: 430 arcsec for the finest pixels of
SKA-Mid. A galaxy with a scale length of 25 arcsec has 0.2 per cent of its flux outside, which comes to lie inside."""

PIXELS_AT_A_TIME = 2**15
"""Number of pixels of the stamps that are transformed together; they and their transforms fit into the level-2 cache.
If stamps were drawn one by one, the interpreter would take most of the time."""

STEEPNESS = 9.0
"""Shape parameter of the Kaiser window whose integral is the taper."""


def render(
    galaxies: Galaxies,
    flux: Float[Array, " source"],
    half_width: Float[Array, " source"],
    tile: Tile,
    band: Band,
    profile: Profile,
) -> Float[Array, "l m"]:
    r"""Draw galaxies on a tile.

    .. math:: \sum_x I(x)\, e^{2\pi i\, k \cdot x} = \sum_s S_s \tilde I_s(k)\, e^{2\pi i\, k \cdot x_s}

    for every k within the band. Beyond its longest baseline the transform falls smoothly to zero at the Nyquist
    frequency, so that each galaxy fits on a stamp.

    Parameters
    ----------
    galaxies
        Galaxies within the tile; their own fluxes are not used.
    flux
        Flux with which each galaxy is drawn [Jy].
    half_width
        Half of the width of each galaxy's stamp, which lies within the tile [rad].
    tile
        Square of pixels to draw on.
    band
        Baselines for which the image is made, and its pixels.
    profile
        Brightness profile.
    """
    forms = np.stack(quadratic_form(galaxies.ellipticity, galaxies.scale_length), axis=-1)
    sizes = [stamp_size(float(width), band.pixel) for width in half_width]
    place = np.column_stack([galaxies.l, galaxies.m])
    return draw(Stamps(place, forms, flux, sizes), tile, band, profile)


@dataclass(frozen=True)
class Stamps:
    """Galaxies to be drawn, each on a stamp of its own.

    Parameters
    ----------
    place
        Position of each galaxy [rad].
    forms
        Quadratic form of each galaxy (``geometry.ellipticity.quadratic_form``) [rad^2].
    flux
        Flux of each galaxy [Jy].
    sizes
        Number of pixels along a side of each stamp.
    steepness
        Shape parameter of the taper beyond the band. The larger it is, the farther the images reach, and the smaller
        is what they have beyond their stamps.
    """

    place: Float[Array, "source 2"]
    forms: Float[Array, "source 3"]
    flux: Float[Array, " source"]
    sizes: Sequence[int]
    steepness: float = STEEPNESS


def draw(stamps: Stamps, tile: Tile, band: Band, profile: Profile) -> Float[Array, "l m"]:
    """Draw galaxies on a tile that holds their stamps, as :func:`render` does."""
    image = np.zeros((tile.size, tile.size), np.float32)
    sizes = np.array(stamps.sizes, dtype=int)
    nearest = np.rint(stamps.place / band.pixel).astype(int)
    offset = stamps.place - nearest * band.pixel
    corner = nearest - np.array(tile.origin) - sizes[:, None] // 2
    # Compiled code would write beyond the image.
    if len(corner) and (corner.min() < 0 or (corner + sizes[:, None]).max() > tile.size):
        raise ValueError("a stamp reaches beyond its tile")
    flux = stamps.flux.astype(np.float32)
    for size in np.unique(sizes).tolist():
        alike = np.flatnonzero(sizes == size)
        count = max(1, PIXELS_AT_A_TIME // size**2)
        for first in range(0, len(alike), count):
            some = alike[first : first + count]
            spectra = transforms_on_stamps(
                stamps.forms[some], offset[some], size, band, profile, stamps.steepness
            )
            kernels.add_stamps(images_of(spectra, size), flux[some], corner[some], image)
    return image


def stamp_size(half_width: float, pixel: float) -> int:
    """Find the number of pixels along a side of a stamp: even, quick to transform, and not too many."""
    size = max(2 * math.ceil(half_width / pixel), SMALLEST_STAMP)
    return fast_size(min(size, LARGEST_STAMP))


def transforms_on_stamps(
    forms: Float[Array, "source 3"],
    offsets: Float[Array, "source 2"],
    size: int,
    band: Band,
    profile: Profile,
    steepness: float = STEEPNESS,
) -> Complex[Array, "source u v"]:
    """Fourier transforms of galaxies of unit flux on stamps, each in the layout of ``irfft2``.

    Parameters
    ----------
    forms
        Quadratic form of each galaxy (``geometry.ellipticity.quadratic_form``) [rad^2].
    offsets
        Position of each galaxy relative to the central pixel [rad].
    size
        Number of pixels along a side, which is even. The central pixel is (size/2, size/2).
    band
        Baselines, and pixels.
    profile
        Brightness profile.
    steepness
        Shape parameter of the taper beyond the band.
    """
    plane = stamp_plane(size, band, steepness)
    along_u, along_v = (np.empty((len(forms), len(k)), np.complex64) for k in (plane.u, plane.v))
    kernels.axis_phases(np.ascontiguousarray(offsets[:, 0]), plane.u, along_u)
    kernels.axis_phases(np.ascontiguousarray(offsets[:, 1]), plane.v, along_v)
    envelopes = profile.envelope(plane.arguments(forms))
    spectra = np.empty((len(forms), len(plane.u), len(plane.v)), np.complex64)
    kernels.plane_spectra(envelopes, plane.taper, plane.reach, along_u, along_v, spectra)
    return spectra


@dataclass(frozen=True)
class StampPlane:
    """Cells of the Fourier transform of a stamp that a band holds.

    Parameters
    ----------
    u, v
        Coordinates of the cells along each axis, in the layout of ``irfft2`` [wavelengths].
    reach
        Number of cells of each row, from the first, up to which the taper is not zero.
    taper
        Taper on these cells, row after row.
    """

    u: Float[Array, " u"]
    v: Float[Array, " v"]
    reach: Int[Array, " u"]
    taper: Float[Array, " cell"]

    def argument(self, form: Float[Array, " 3"]) -> Float[Array, " cell"]:
        """Argument q of the envelope of a galaxy with this quadratic form [rad^2]."""
        return self.arguments(form[None])[0]

    def arguments(self, forms: Float[Array, "source 3"]) -> Float[Array, "source cell"]:
        """Argument q of the envelope of each galaxy with these quadratic forms [rad^2]."""
        q = np.empty((len(forms), len(self.taper)), np.float32)
        scaled = (4 * math.pi**2 * forms).astype(np.float32)
        kernels.plane_arguments(self.u, self.v, self.reach, scaled, q)
        return q

    def phases(
        self, offset: tuple[float, float]
    ) -> tuple[Complex[Array, " u"], Complex[Array, " v"]]:
        """Phases along each axis of a galaxy at an offset from the pixel at the origin [rad]."""
        along_u, along_v = (
            np.exp(-2j * math.pi * x * k).astype(np.complex64)
            for x, k in zip(offset, (self.u, self.v), strict=True)
        )
        return along_u, along_v


@lru_cache(maxsize=64)
def stamp_plane(size: int, band: Band, steepness: float = STEEPNESS) -> StampPlane:
    """Return the cells of a stamp.

    Parameters
    ----------
    size
        Number of pixels along a side.
    band
        Baselines, and pixels.
    steepness
        Shape parameter of the taper beyond the band.
    """
    u = fft.fftfreq(size, band.pixel).astype(np.float32)
    v = fft.rfftfreq(size, band.pixel).astype(np.float32)
    taper = smooth_step(np.hypot(u[:, None], v[None, :]), band.longest, 0.5 / band.pixel, steepness)
    reach = np.sum(taper > 0, axis=1)
    return StampPlane(u, v, reach, taper[np.arange(len(v)) < reach[:, None]])


def smooth_step(
    x: Float[Array, "..."], start: float, stop: float, steepness: float = STEEPNESS
) -> Float[Array, "..."]:
    """Fall from 1 at ``start`` to 0 at ``stop``, as the integral of a Kaiser window."""
    t = np.linspace(-1, 1, 2001)
    mass = np.cumsum(np.i0(steepness * np.sqrt(1 - t**2)))
    fall = 1 - mass / mass[-1]
    place = (x - start) / (stop - start) * 2 - 1
    return np.interp(place, t, fall, left=1.0, right=0.0).astype(np.float32)
