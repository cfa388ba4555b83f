"""The dirty image of a field, and its residual image after the sky model is subtracted.

Both come from one pass over the visibilities. They have natural weights, and the w-planes of the gridder make them
exact over the whole field.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from uvshear.constants import ARCSEC, SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.galaxy import Galaxies, Profile
from uvshear.imaging import ImageGrid
from uvshear.imaging.bands import (
    OVERSAMPLING,
    longest_seen,
    numbers_of_bands,
    octaves,
    steepest,
)
from uvshear.imaging.curvature import half_widths_of_bands
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.tiles import Footprint, plan_tiles
from uvshear.imaging.uv_order import in_uv_order, uv_order
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.summary import ObservationSummary
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.numerics.fft_sizes import fast_size
from uvshear.predict import predict_visibilities
from uvshear.predict.blocks import BlockAccumulator
from uvshear.predict.gridded import Gridding, ModelledSky, predict_samples, slabs
from uvshear.predict.response import Response
from uvshear.typing import Array, Complex, Float

MOST_PIXELS = 4096
FEWEST_PIXELS = 64
"""Largest and smallest number of pixels across an image."""

WIDEST = 1.0
"""Largest width of an image, in direction cosines: its corners stay above the horizon."""

COMFORTABLE = 1.5
"""Nyquist frequency of the pixels over the longest baseline, where ``MOST_PIXELS`` allows; at least
``imaging.bands.OVERSAMPLING`` in any case."""

MARGIN = 30 * ARCSEC
RELATIVE_MARGIN = 0.1
"""Margin of sky beyond the outermost source: the larger of a length [rad] and a fraction of the source's distance."""

DIRECT = 2e9
"""Number of sources times samples up to which the models are summed directly, which takes ten seconds."""

REACH = 14.0
"""Distance to which a galaxy is drawn [long-axis scale lengths]: 1e-5 of an exponential disc's flux is beyond."""

POINT_STAMP = 128
"""Width to which the smallest source is drawn [finest pixels]: its image rings out to the scale of the taper."""

Predict = Callable[[Samples], Complex[Array, " sample"]]
"""Function that predicts the visibilities of a sky [Jy]."""

Step = Callable[[int], None]
"""Function that is called with the number of samples that have been predicted or imaged."""


@dataclass(frozen=True)
class DirtyAndResidual:
    """Two images of one field with natural weights.

    Parameters
    ----------
    dirty
        Image of the data [Jy/beam].
    residual
        Image of the data less all models [Jy/beam].
    grid
        Pixels, about the phase centre.
    weight
        Sum of the weights of the visibilities that were used [Jy^-2].
    frequency
        Weighted mean of their frequencies [Hz].
    uv_range
        Baselines that were used: the requested ones that the pixels can represent.
    samples
        Number of visibilities that were used.
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
        """Standard deviation of either image if the data were noise alone [Jy/beam]."""
        return 1 / math.sqrt(self.weight)

    @property
    def rms(self) -> float:
        """Root mean square of the residual over the whole image [Jy/beam]."""
        return root_mean_square(self.residual)


def root_mean_square(image: Float[Array, "l m"]) -> float:
    """Root mean square of all pixels, about zero."""
    return float(np.sqrt(np.mean(np.square(image, dtype=float))))


def residual_image(
    observation: Observation,
    sky: Galaxies,
    profile: Profile,
    *,
    summary: ObservationSummary,
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
        The sky that is subtracted; sources without flux are ignored.
    summary
        Summary of the observation.
    uv_range
        Baselines to image; all unless given.
    attenuation
        Attenuation of the sources; none unless given.
    step
        Called with the number of samples that have been predicted (once each) and imaged (twice each).

    Notes
    -----
    An image has at most ``MOST_PIXELS`` pixels across. Baselines beyond Nyquist / 1.2 of these pixels are left out:
    above 8.4e5 wavelengths for a field 7 arcmin wide, above 9e4 for 65 arcmin.
    """
    uv_range, gridding = uv_range or UvRange(), gridding or Gridding()
    sky = sky.select(np.flatnonzero(sky.flux != 0))
    grid, used = plan_image(sky, uv_range, summary.longest)
    longest = _beyond(used)
    predict: Predict | None = None
    if len(sky):
        response = Response.from_sky(sky, summary.probes, attenuation)
        modelled = _modelled(sky, profile, response, grid, longest)
        chosen = _direct if len(sky) * summary.samples <= DIRECT else _tiled
        predict = chosen(modelled, used.minimum, longest, gridding)
    accumulator = ResidualImageAccumulator(grid, used, predict, gridding, step)
    (images,) = accumulate(observation, [accumulator])
    return images


def _beyond(uv_range: UvRange) -> float:
    """Upper end of a half-open range that includes the longest baseline itself [wavelengths]."""
    return uv_range.maximum * (1 + 1e-9)


class ResidualImageAccumulator(BlockAccumulator[DirtyAndResidual]):
    """Dirty and residual image of the samples of a range of baselines.

    Parameters
    ----------
    grid
        Pixels, about the phase centre.
    uv_range
        Baselines that are used.
    predict
        Function that predicts the models for samples; None for an empty sky.
    gridding
        Accuracy and resources.
    step
        Called with the number of samples that have been predicted or imaged.
    """

    def __init__(
        self,
        grid: ImageGrid,
        uv_range: UvRange,
        predict: Predict | None,
        gridding: Gridding,
        step: Step | None = None,
    ) -> None:
        super().__init__(uv_range.minimum, _beyond(uv_range), gridding)
        self._grid, self._uv_range, self._predict = grid, uv_range, predict
        self._gridding, self._step = gridding, step
        self._images = np.zeros((2, grid.size, grid.size))
        self._weight = self._weighted_frequency = 0.0
        self._count = 0

    def add_block(self, samples: Samples) -> None:
        """Predict the models of a block, and image its data and its residuals."""
        samples = in_uv_order(samples, self._gridding.executor)
        residual = samples.stokes_i
        if self._predict is not None:
            residual = residual - self._predict(samples)
        self._report(len(samples))
        self._add_images(samples, residual)
        self._weight += float(samples.weights.sum(dtype=float))
        self._weighted_frequency += float(np.sum(samples.weights * samples.frequency))
        self._count += len(samples)

    def add_sums(self, later: Self) -> None:
        """Add the images of later visibilities."""
        self._images += later._images
        self._weight += later._weight
        self._weighted_frequency += later._weighted_frequency
        self._count += later._count

    def total(self) -> DirtyAndResidual:
        """Return the two images."""
        weight, used = self._weight, self._uv_range
        if weight == 0:
            raise InputError(
                f"no visibility from {used.minimum:g} to {used.maximum:g} wavelengths carries weight:"
                " a residual image cannot be made"
            )
        dirty, residual = (self._images / weight).astype(np.float32)
        frequency = self._weighted_frequency / weight
        return DirtyAndResidual(dirty, residual, self._grid, weight, frequency, used, self._count)

    def _add_images(self, samples: Samples, residual: Complex[Array, " sample"]) -> None:
        """Add weight times data and weight times residual, imaged, to the two images."""
        grid, gridding = self._grid, self._gridding

        def image(task: tuple[int, slice]) -> tuple[int, int, Float[Array, "l m"]]:
            which, rows = task
            vis = (residual if which else samples.stokes_i)[rows] * samples.weights[rows]
            plane = TangentPlane.at(samples.uvw[rows], 0.0, 0.0)
            return which, len(vis), plane.image(vis, grid.size, grid.pixel, gridding.epsilon)

        tasks = ((which, rows) for rows in slabs(len(samples)) for which in (0, 1))
        # Each worker holds an image.
        executor = gridding.executor_for(grid.size, len(samples))
        for which, count, part in executor.map(image, tasks):
            self._images[which] += part
            self._report(count)

    def _report(self, samples: int) -> None:
        if self._step is not None:
            self._step(samples)


def plan_image(sky: Galaxies, uv_range: UvRange, longest: float) -> tuple[ImageGrid, UvRange]:
    """Choose pixels that hold every source; return them with the baselines [wavelengths] that they represent.

    ``longest`` is the longest baseline of the observation.
    """
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
            f"--uv-min {uv_range.minimum:g}: a residual image of {size} pixels that covers every source can"
            f" represent only baselines up to {carried:.4g} wavelengths; lower --uv-min, or leave out the residual"
            " image"
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
    """Predict by the sum over sources."""
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
    """Predict by images on tiles, a band of baselines at a time."""
    footprint = Footprint(sky.galaxies.l, sky.galaxies.m, sky.half_width)
    lm = np.column_stack([footprint.l, footprint.m])
    span = float(np.ptp(lm, axis=0).max()) + 2 * float(sky.half_width.max())
    slope, radius = steepest(*lm.T), float(np.hypot(*lm.T).max())
    probes = sky.response.probes
    some = np.zeros((0, 3)) if probes is None else probes.uvw[probes.uv_distance < longest]
    seen = longest_seen(some, slope)
    bands = octaves(shortest, float(seen.max(initial=longest)), span)
    limits = half_widths_of_bands(some, numbers_of_bands(bands, seen), len(bands), radius)
    tiles = plan_tiles(footprint, bands[0].pixel, len(bands), half_widths=limits)

    def predict(samples: Samples) -> Complex[Array, " sample"]:
        model = np.zeros(len(samples), np.complex64)
        number = numbers_of_bands(bands, longest_seen(samples.uvw, slope))
        for b, (band, on_it) in enumerate(zip(bands, tiles, strict=True)):
            chosen = np.flatnonzero(number == b)
            chosen = chosen[uv_order(samples.uvw[chosen])]
            if len(chosen):
                part = samples.taken(chosen, gridding.executor)
                model[chosen] = predict_samples(part, on_it, band, sky, gridding)
        return model

    return predict
