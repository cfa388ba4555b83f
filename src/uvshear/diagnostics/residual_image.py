"""What is left of a field when its sky is taken away, for the eye: the dirty image, and that of the residual.

One visit of the visibilities. Both images have natural weights, and the w-planes of the gridder make them exact over
the whole field.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from uvshear.constants import ARCSEC, SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.extraction.converged.major_cycle import (
    BYTES_PER_SAMPLE,
    Gridding,
    ModelledSky,
    Step,
    blocks,
    predict_samples,
    slabs,
)
from uvshear.galaxy import Galaxies, Profile
from uvshear.imaging import ImageGrid
from uvshear.imaging.bands import OVERSAMPLING, octaves
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.tiles import Footprint, plan_tiles
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.summary import Extent
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.numerics.fft_sizes import fast_size
from uvshear.predict import predict_visibilities
from uvshear.predict.response import Response
from uvshear.typing import Array, Complex, Float

MOST_PIXELS = 4096
FEWEST_PIXELS = 64
"""Across an image."""

WIDEST = 1.0
"""Across an image, in direction cosines: its corners stay above the horizon."""

COMFORTABLE = 1.5
"""Nyquist frequency of the pixels over the longest baseline, where ``MOST_PIXELS`` allows; at least
``imaging.bands.OVERSAMPLING`` in any case."""

MARGIN = 30 * ARCSEC
RELATIVE_MARGIN = 0.1
"""Sky beyond the outermost source, the larger of the two; the second over that source's distance."""

DIRECT = 2e9
"""Sources times samples up to which the models are summed directly: ten seconds."""

REACH = 14.0
"""Long-axis scale lengths that are drawn of a galaxy: 1e-5 of an exponential disc's flux is beyond."""

POINT_STAMP = 128
"""Finest pixels across the smallest source that is drawn: its image rings until the taper has worn off."""

BYTES_PER_PIXEL = 60
"""What a pixel takes while it is worked on: itself, and the oversampled plane of the gridder."""

Predict = Callable[[Samples], Complex[Array, " sample"]]


@dataclass(frozen=True)
class DirtyAndResidual:
    """Two images of one field with natural weights.

    Parameters
    ----------
    dirty
        Of the data [Jy/beam].
    residual
        Of the data less all models [Jy/beam].
    grid
        Pixels, about the phase centre.
    weight
        Sum of the weights that went in [Jy^-2].
    frequency
        Weighted mean [Hz].
    uv_range
        Baselines that went in: those that were asked for and that the pixels can carry.
    samples
        Number of visibilities that went in.
    """

    dirty: Float[Array, "l m"]
    residual: Float[Array, "l m"]
    grid: ImageGrid
    weight: float
    frequency: float
    uv_range: UvRange
    samples: int

    @property
    def noise(self) -> float:
        """Standard deviation of either image where nothing but noise is in the data [Jy/beam]."""
        return 1 / math.sqrt(self.weight)

    @property
    def rms(self) -> float:
        """Of the residual, over the whole image [Jy/beam]."""
        return root_mean_square(self.residual)


def root_mean_square(image: Float[Array, "l m"]) -> float:
    """Over all pixels, about zero."""
    return float(np.sqrt(np.mean(np.square(image, dtype=float))))


def residual_image(
    observation: Observation,
    sky: Galaxies,
    profile: Profile,
    *,
    extent: Extent,
    uv_range: UvRange | None = None,
    gridding: Gridding | None = None,
    attenuation: Attenuation | None = None,
    step: Step | None = None,
) -> DirtyAndResidual:
    r"""Image the data, and the data less a sky, on a square that holds every source.

    .. math:: b(l, m) = \frac{1}{\sum_k w_k} \sum_k w_k \mathrm{Re}[d_k e^{-2\pi i (u_k l + v_k m + w_k (n - 1))}]

    A point source of S Jy at (l, m) makes b(l, m) = S.

    Parameters
    ----------
    sky
        What is subtracted; sources without flux do not count.
    extent
        Of the observation.
    uv_range
        Baselines to image; all unless given.
    attenuation
        Of each source.
    step
        Hears how many samples have been predicted (once each) and imaged (twice each).

    Notes
    -----
    An image has at most ``MOST_PIXELS`` pixels across. Baselines beyond Nyquist / 1.2 of these pixels are left out:
    above 8.4e5 wavelengths for a field 7 arcmin wide, above 9e4 for 65 arcmin.
    """
    uv_range, gridding = uv_range or UvRange(), gridding or Gridding()
    sky = sky.select(np.flatnonzero(sky.flux != 0))
    grid, used = plan_image(sky, uv_range, extent.longest)
    longest = used.maximum * (1 + 1e-9)  # the longest baseline itself takes part
    chosen = _direct if len(sky) * extent.samples <= DIRECT else _tiled
    predict = chosen(
        _modelled(sky, profile, Response.from_sky(sky, extent.probes, attenuation), grid, longest),
        used.minimum,
        longest,
        gridding,
    )
    both = np.zeros((2, grid.size, grid.size))
    weight = weighted_frequency = 0.0
    count = 0
    for samples in blocks(observation, used.minimum, longest, gridding.block):
        left = samples.stokes_i - predict(samples) if len(sky) else samples.stokes_i
        if step is not None:
            step(len(samples))
        _add_images(samples, left, grid, gridding, both, step)
        weight += float(samples.weights.sum(dtype=float))
        weighted_frequency += float(np.sum(samples.weights * samples.frequency))
        count += len(samples)
    if weight == 0:
        raise InputError(
            f"no visibility from {used.minimum:g} to {used.maximum:g} wavelengths carries weight:"
            " there is nothing to make a residual image of"
        )
    dirty, residual = (both / weight).astype(np.float32)
    frequency = weighted_frequency / weight
    return DirtyAndResidual(dirty, residual, grid, weight, frequency, used, count)


def plan_image(sky: Galaxies, uv_range: UvRange, longest: float) -> tuple[ImageGrid, UvRange]:
    """Pixels that hold every source, and the baselines [wavelengths] that they carry; ``longest`` is what there is."""
    outermost = float(np.max(np.abs([sky.l, sky.m]), initial=0.0))
    width = min(2 * (outermost + max(MARGIN, RELATIVE_MARGIN * outermost)), WIDEST)
    wanted = min(uv_range.maximum, longest)
    pixel = min(1 / (2 * COMFORTABLE * wanted), WIDEST / FEWEST_PIXELS)
    size = max(math.ceil(width / pixel), FEWEST_PIXELS)
    if size > MOST_PIXELS:
        size, pixel = MOST_PIXELS, width / MOST_PIXELS
    size = fast_size(size, real=False)
    carried = min(wanted, 1 / (2 * OVERSAMPLING * pixel))
    if uv_range.minimum >= carried:
        raise InputError(
            f"--uv-min {uv_range.minimum:g}: an image of {size} pixels that holds every source carries"
            f" baselines up to {carried:.4g} wavelengths; a lower uv-min, or no residual image"
        )
    return ImageGrid(size, pixel), UvRange(uv_range.minimum, carried)


def _modelled(
    sky: Galaxies, profile: Profile, response: Response, grid: ImageGrid, longest: float
) -> ModelledSky:
    widest = grid.size * grid.pixel / 2
    half = np.minimum(REACH * sky.scale_length / (1 - np.abs(sky.ellipticity)), widest)
    finest = 1 / (2 * OVERSAMPLING * longest)
    return ModelledSky(sky, np.maximum(half, POINT_STAMP / 2 * finest), response, profile)


def _direct(sky: ModelledSky, shortest: float, longest: float, gridding: Gridding) -> Predict:
    """Models summed source by source."""
    galaxies, response = sky.galaxies, sky.response
    shared = response.shared_factors(galaxies, shortest, longest)
    flat = np.zeros(len(galaxies))
    in_wavelengths = np.array([SPEED_OF_LIGHT])

    def predict(samples: Samples) -> Complex[Array, " sample"]:
        model = np.zeros(len(samples), np.complex64)
        for source, coefficients in zip(shared.chosen, shared.coefficients, strict=True):
            part = replace(galaxies, flux=galaxies.flux * coefficients, spectral_index=flat)
            vis = predict_visibilities(
                part, samples.uvw, in_wavelengths, sky.profile, gridding.executor
            )
            l, m = float(galaxies.l[source]), float(galaxies.m[source])
            index = float(galaxies.spectral_index[source])
            model += vis[:, 0] * response.source_factor(samples, l, m, index)
        return model * response.gain(samples.frequency)

    return predict


def _tiled(sky: ModelledSky, shortest: float, longest: float, gridding: Gridding) -> Predict:
    """Models drawn on tiles, a band of baselines at a time."""
    footprint = Footprint(sky.galaxies.l, sky.galaxies.m, sky.half_width)
    lm = np.column_stack([footprint.l, footprint.m])
    span = float(np.ptp(lm, axis=0).max()) + 2 * float(sky.half_width.max())
    bands = octaves(shortest, longest, span)
    tiles = plan_tiles(footprint, bands[0].pixel, len(bands))

    def predict(samples: Samples) -> Complex[Array, " sample"]:
        model = np.zeros(len(samples), np.complex64)
        distance = samples.uv_distance
        for band, on_it in zip(bands, tiles, strict=True):
            chosen = np.flatnonzero(band.holds(distance))
            if len(chosen):
                part = samples.select(chosen)
                model[chosen] = predict_samples(part, on_it, band, sky, gridding)
        return model

    return predict


def _add_images(
    samples: Samples,
    left: Complex[Array, " sample"],
    grid: ImageGrid,
    gridding: Gridding,
    both: Float[Array, "image l m"],
    step: Step | None,
) -> None:
    """Add weight times data and weight times residual, imaged, to the two images."""

    def image(task: tuple[int, slice]) -> tuple[int, int, Float[Array, "l m"]]:
        which, rows = task
        vis = (left if which else samples.stokes_i)[rows] * samples.weights[rows]
        plane = TangentPlane.at(samples.uvw[rows], 0.0, 0.0)
        return which, len(vis), plane.image(vis, grid.size, grid.pixel, gridding.epsilon)

    tasks = ((which, rows) for rows in slabs(len(samples)) for which in (0, 1))
    at_once = gridding.block * BYTES_PER_SAMPLE // (grid.size**2 * BYTES_PER_PIXEL)
    executor = max(1, min(gridding.executor, at_once))
    for which, count, part in executor.map(image, tasks):
        both[which] += part
        if step is not None:
            step(count)
