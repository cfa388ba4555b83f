"""The dirty beam over the field: it changes by one per cent in half a degree, so that a few directions are enough."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Self

import numpy as np
from scipy import fft
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from uvshear.imaging.cutout import Cutout
from uvshear.imaging.tangent import TangentPlane
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.blocks import BlockAccumulator
from uvshear.predict.gridded import Gridding, slabs
from uvshear.predict.rendering import smooth_step
from uvshear.predict.response import Response
from uvshear.typing import Array, Float, Int

SIZE = 704
"""Side of a beam's image [pixels]: 197 arcsec for SKA-Mid, the reach of the interaction between major cycles."""

SPACING = math.radians(0.3)
"""Greatest distance between neighbouring directions, along l or m [rad]. At half this distance the beam is stretched by
about 0.1 per cent. That affects the noise and not the shape, because the beam does not enter the residual."""

WIDE_SIZE = 256
WIDE_BAND = 1 / 20
"""Side in pixels, and longest baseline over that of the facets, of a coarse beam that shows how far the plateau of
the short baselines reaches: 730 arcsec for SKA-Mid."""

NANOSECONDS = 200
"""Cost of a sample in one beam [nanoseconds]."""


@dataclass(frozen=True)
class Beams:
    """Dirty beams [Jy^-2] in several directions, and the beam of each source.

    Parameters
    ----------
    images
        Beam in each direction, on pixels of ``pixel`` [rad], with its centre at (SIZE/2, SIZE/2).
    nearest
        Number of the direction of each source.
    pixel
        Width of the pixels [rad].
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
    """Transform of a beam on pixels twice as wide, in the layout of ``irfft2``."""
    spectrum = fft.rfft2(fft.ifftshift(beam)).real
    half = SIZE // 2
    rows = np.concatenate([spectrum[: half // 2], spectrum[-half // 2 :]])
    # There are four fine pixels to a coarse one.
    return (rows[:, : half // 2 + 1] / 4).astype(np.float32)


def power_of(beam: Float[Array, "l m"], cutout: Cutout) -> Float[Array, " cell"]:
    """Power of a facet's cells."""
    first = SIZE // 2 - cutout.size // 2
    square = slice(first, first + cutout.size)
    return cutout.transform(beam[square, square]).real


def directions(
    lm: Float[Array, "source 2"],
) -> tuple[Float[Array, "node 2"], Int[Array, " source"]]:
    """Lattice of directions within ``SPACING`` of each other and near a source; and the nearest to each source."""
    low, extent = lm.min(axis=0), np.ptp(lm, axis=0)
    parts = np.maximum(1, np.ceil(extent / SPACING).astype(int))
    axes = [low[x] + extent[x] * (np.arange(parts[x]) + 0.5) / parts[x] for x in (0, 1)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    _, index = cKDTree(lattice).query(lm)
    used, nearest = np.unique(index, return_inverse=True)
    return lattice[used], nearest.ravel()


@dataclass(frozen=True)
class BeamPlan:
    """Beams that are to be accumulated.

    Parameters
    ----------
    nodes
        Direction cosines of the beams.
    nearest
        Number of the direction of each source.
    shortest, longest
        Range of the baselines that are used [wavelengths].
    pixel
        Width of the pixels [rad].
    """

    nodes: Float[Array, "node 2"]
    nearest: Int[Array, " source"]
    shortest: float
    longest: float
    pixel: float

    @classmethod
    def around(
        cls, lm: Float[Array, "source 2"], shortest: float, longest: float, pixel: float
    ) -> Self:
        """Plan the beams around sources at ``lm``."""
        nodes, nearest = directions(lm)
        return cls(nodes, nearest, shortest, longest, pixel)


class BeamAccumulator(BlockAccumulator[Beams]):
    """Dirty beams of all directions of a plan.

    Parameters
    ----------
    plan
        Directions, baselines and pixels.
    response
        Spectrum and attenuation of the sources.
    gridding
        Accuracy and resources.
    on_work
        Function called after each beam with the work that it took [nanoseconds].
    """

    def __init__(
        self,
        plan: BeamPlan,
        response: Response,
        gridding: Gridding,
        on_work: Callable[[float], None] | None = None,
    ) -> None:
        super().__init__(plan.shortest, plan.longest, gridding.block)
        self._plan, self._response, self._gridding = plan, response, gridding
        self._on_work = on_work
        self._images = np.zeros((len(plan.nodes), SIZE, SIZE), np.float32)
        self._wide = np.zeros((WIDE_SIZE, WIDE_SIZE), np.float32)
        self._wide_pixel = plan.pixel / WIDE_BAND

    def add_sums(self, later: Self) -> None:
        """Add the beams of later visibilities."""
        self._images += later._images
        self._wide += later._wide

    def total(self) -> Beams:
        """Return the beams."""
        plan = self._plan
        return Beams(self._images, plan.nearest, plan.pixel, self._wide, self._wide_pixel)

    def add_block(self, samples: Samples) -> None:
        """Image the weights of a block in every direction."""
        plan, response, gridding = self._plan, self._response, self._gridding
        unit = (samples.weights * response.gain(samples.frequency) ** 2).astype(np.complex64)
        self._add_short(samples, unit)

        def image(task: tuple[int, slice]) -> tuple[int, Float[Array, "l m"], int]:
            node, rows = task
            # Phased to the direction itself a beam has its centre there.
            plane = TangentPlane.at(samples.uvw[rows], *plan.nodes[node])
            left = response.matched_filter(samples.select(rows), *plan.nodes[node].tolist())
            beam = plane.beam(unit[rows] * left**2, SIZE, plan.pixel, gridding.epsilon)
            return node, beam, len(plane.phase)

        tasks = [(node, rows) for node in range(len(plan.nodes)) for rows in slabs(len(samples))]
        for node, part, count in gridding.executor.map(image, tasks):
            self._images[node] += part
            if self._on_work is not None:
                self._on_work(NANOSECONDS * count)

    def _add_short(self, samples: Samples, unit: Array) -> None:
        short = samples.uv_distance < WIDE_BAND * self._plan.longest
        uvw, unit = samples.uvw[short], unit[short]
        for rows in slabs(len(unit)):
            plane = TangentPlane.at(uvw[rows], *self._plan.nodes[0])
            self._wide += plane.beam(
                unit[rows], WIDE_SIZE, self._wide_pixel, self._gridding.epsilon
            )


def gather_beams(
    observation: Observation, plan: BeamPlan, response: Response, gridding: Gridding
) -> Beams:
    """Read the visibilities once, for the beams only."""
    (beams,) = accumulate(observation, [BeamAccumulator(plan, response, gridding)])
    return beams
