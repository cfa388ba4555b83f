"""The dirty beam over the field: it changes by a per cent in half a degree, so a few directions are enough."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy import fft
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from uvshear.extraction.converged.major_cycle import Gridding, blocks, slabs
from uvshear.imaging.cutout import Cutout
from uvshear.imaging.tangent import TangentPlane
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.rendering import smooth_step
from uvshear.predict.response import Response
from uvshear.typing import Array, Float, Int

SIZE = 704
"""Pixels of a beam's side: 197 arcsec for SKA-Mid, the reach of what sources do to one another between visits."""

SPACING = math.radians(0.3)
"""Greatest distance between neighbouring directions, along l or m [rad]. Half of it stretches the beam by about
0.1 per cent. That is an error of the noise, not of the shape: the residual does not know the beam."""

WIDE_SIZE = 256
WIDE_BAND = 1 / 20
"""Side in pixels, and longest baseline over that of the facets, of a coarse beam that shows how far the plateau of
the short baselines reaches: 730 arcsec for SKA-Mid."""

NANOSECONDS = 200
"""Cost of a sample and beam."""


@dataclass(frozen=True)
class Beams:
    """Dirty beams [Jy^-2] in some directions, and which of them each source takes.

    Parameters
    ----------
    images
        Of each direction, on pixels of ``pixel`` [rad], the centre at (SIZE/2, SIZE/2).
    nearest
        Direction of each source.
    wide
        Coarse beam of the short baselines in one direction, on pixels of ``wide_pixel`` [rad].
    """

    images: Float[Array, "node l m"]
    nearest: Int[Array, " source"]
    pixel: float
    wide: Float[Array, "wide_l wide_m"]
    wide_pixel: float
    _powers: dict[tuple[int, Cutout], Float[Array, " cell"]] = field(default_factory=dict)

    def power(self, source: int, cutout: Cutout) -> Float[Array, " cell"]:
        """Power of a facet's cells; sources of one size and one beam share it."""
        node = int(self.nearest[source])
        if (node, cutout) not in self._powers:
            self._powers[node, cutout] = power_of(self.images[node], cutout)
        return self._powers[node, cutout]

    def plateau(self, apart: Float[Array, "pair 2"]) -> Float[Array, " pair"]:
        """Beam of the short baselines at distances along l and m [rad]; 0 beyond its image."""
        place = apart.T / self.wide_pixel + WIDE_SIZE // 2
        return map_coordinates(self.wide, place, order=1, mode="constant")

    def ending(self, node: int, start: float, end: float) -> Float[Array, "l m"]:
        """Return a beam that ends smoothly between the distances ``start`` and ``end`` [pixels]."""
        x = np.arange(SIZE) - SIZE // 2
        window = smooth_step(np.hypot(x[:, None], x[None, :]), start, end)
        return self.images[node] * window


def coarse_spectrum(beam: Float[Array, "l m"]) -> Float[Array, "u v"]:
    """Transform of a beam on pixels twice as wide, as ``irfft2`` takes it."""
    spectrum = fft.rfft2(fft.ifftshift(beam)).real
    half = SIZE // 2
    rows = np.concatenate([spectrum[: half // 2], spectrum[-half // 2 :]])
    # Four fine pixels to a coarse one.
    return (rows[:, : half // 2 + 1] / 4).astype(np.float32)


def power_of(beam: Float[Array, "l m"], cutout: Cutout) -> Float[Array, " cell"]:
    """Power of a facet's cells."""
    first = SIZE // 2 - cutout.size // 2
    square = slice(first, first + cutout.size)
    return cutout.transform(beam[square, square]).real


def gather_beams(
    observation: Observation,
    lm: Float[Array, "source 2"],
    uv_range: tuple[float, float],
    pixel: float,
    response: Response,
    gridding: Gridding,
    step: Callable[[float], None] | None = None,
) -> Beams:
    """Visit the visibilities for the beams around sources at ``lm``."""
    nodes, nearest = directions(lm)
    images = np.zeros((len(nodes), SIZE, SIZE), np.float32)
    wide, wide_pixel = np.zeros((WIDE_SIZE, WIDE_SIZE), np.float32), pixel / WIDE_BAND
    for samples in blocks(observation, *uv_range, gridding.block):
        unit = (samples.weights * response.gain(samples.frequency) ** 2).astype(np.complex64)
        short = samples.uv_distance < WIDE_BAND * uv_range[1]
        for rows in slabs(int(short.sum())):
            plane = TangentPlane.at(samples.uvw[short][rows], *nodes[0])
            wide += plane.beam(unit[short][rows], WIDE_SIZE, wide_pixel, gridding.epsilon)
        # Phased to the direction itself a beam has its centre there.
        tasks = [(node, rows) for node in range(len(nodes)) for rows in slabs(len(samples))]

        def image(
            task: tuple[int, slice], samples: Samples = samples, unit: Array = unit
        ) -> tuple[int, Float[Array, "l m"], int]:
            node, rows = task
            plane = TangentPlane.at(samples.uvw[rows], *nodes[node])
            seen = unit[rows] * response.matched_filter(samples.select(rows), *nodes[node].tolist()) ** 2
            return node, plane.beam(seen, SIZE, pixel, gridding.epsilon), len(plane.phase)

        for node, part, count in gridding.executor.map(image, tasks):
            images[node] += part
            if step is not None:
                step(NANOSECONDS * count)
    return Beams(images, nearest, pixel, wide, wide_pixel)


def directions(
    lm: Float[Array, "source 2"],
) -> tuple[Float[Array, "node 2"], Int[Array, " source"]]:
    """Lattice of directions within ``SPACING``, those next to no source left out; and the nearest to each source."""
    low, extent = lm.min(axis=0), np.ptp(lm, axis=0)
    parts = np.maximum(1, np.ceil(extent / SPACING).astype(int))
    axes = [low[x] + extent[x] * (np.arange(parts[x]) + 0.5) / parts[x] for x in (0, 1)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    _, index = cKDTree(lattice).query(lm)
    used, nearest = np.unique(index, return_inverse=True)
    return lattice[used], nearest.ravel()
