"""The dirty beam of every source of the field, in terms of a few.

Two causes make the beams of two sources differ. The baselines are projected onto the plane tangent to the sky at the
source, which changes the beam by one per cent in half a degree: a lattice of directions is enough for it. Smearing,
primary beams and spectra, which the filter of a source matches, may change much faster. The squares of the filters
of all sources near a direction are combinations of those of a few of them (``Response.shared_filters``), and so are
their beams: one beam is accumulated for each of these few, and the beam of a source is a mixture of them.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Self

import numpy as np
from scipy import fft
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from uvshear.galaxy import Galaxies
from uvshear.imaging.cutout import Cutout
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.uv_order import in_uv_order
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.blocks import BlockAccumulator
from uvshear.predict.gridded import Gridding, slabs
from uvshear.predict.rendering import smooth_step
from uvshear.predict.response import Response, SeenAs, seen_as
from uvshear.typing import Array, Complex, Float, Int

SIZE = 704
"""Side of a beam's image [pixels]: 197 arcsec for SKA-Mid, the reach of the interaction between major cycles."""

SPACING = math.radians(0.3)
"""Greatest distance between neighbouring directions, along l or m [rad]. At half this distance the projection of the
baselines stretches the beam by about 0.1 per cent. That affects the noise and not the shape, because the beam does not
enter the residual."""

WIDE_SIZE = 256
WIDE_BAND = 1 / 20
"""Side in pixels, and longest baseline over that of the facets, of a coarse beam that shows how far the plateau of
the short baselines reaches: 730 arcsec for SKA-Mid."""

_WIDE = -1
"""Number of the coarse beam among the images."""

NANOSECONDS = 200
"""Cost of a sample in one beam [nanoseconds]."""

NEGLIGIBLE = 1e-5
"""Share of a beam in a mixture below which the beam is left out."""


@dataclass(frozen=True)
class Mixture:
    """The beam of a source as a sum of some beams, each times its share."""

    beams: tuple[int, ...]
    shares: tuple[float, ...]

    @classmethod
    def from_shares(cls, beams: Sequence[int], shares: Float[Array, " beam"]) -> Self:
        """Leave out beams of negligible share."""
        kept = [
            (beam, share)
            for beam, share in zip(beams, shares.tolist(), strict=True)
            if abs(share) > NEGLIGIBLE
        ]
        return cls(tuple(beam for beam, _ in kept), tuple(share for _, share in kept))

    def mixed(self, quantity: Callable[[int], Float[Array, "..."]]) -> Float[Array, "..."]:
        """Mix a quantity that each beam has and that is linear in the beam."""
        if self.shares == (1.0,):
            return quantity(self.beams[0])
        total = quantity(self.beams[0]) * np.float32(self.shares[0])
        for beam, share in zip(self.beams[1:], self.shares[1:], strict=True):
            total += quantity(beam) * np.float32(share)
        return total


@dataclass(frozen=True)
class Beams:
    """Dirty beams [Jy^-2], and the mixture of them that is the beam of each source.

    Parameters
    ----------
    images
        Beams on pixels of ``pixel`` [rad], with their centres at (SIZE/2, SIZE/2).
    mixtures
        Mixture of each source.
    pixel
        Width of the pixels [rad].
    wide
        Coarse beam of the short baselines in one direction, on pixels of ``wide_pixel`` [rad].
    """

    images: Float[Array, "beam l m"]
    mixtures: tuple[Mixture, ...]
    pixel: float
    wide: Float[Array, "wide_l wide_m"]
    wide_pixel: float
    _powers: dict[tuple[int, Cutout], Float[Array, " cell"]] = field(default_factory=dict)

    def add(self, later: Self) -> None:
        """Add beams of later visibilities, before anything is worked out from them."""
        self.images[...] += later.images
        self.wide[...] += later.wide

    def power(self, source: int, cutout: Cutout) -> Float[Array, " cell"]:
        """Power of a facet's cells; sources of one size share the powers that are mixed."""
        return self.mixtures[source].mixed(partial(self._power_of_beam, cutout))

    def _power_of_beam(self, cutout: Cutout, beam: int) -> Float[Array, " cell"]:
        if (beam, cutout) not in self._powers:
            self._powers[beam, cutout] = power_of(self.images[beam], cutout)
        return self._powers[beam, cutout]

    def plateau(self, apart: Float[Array, "pair 2"]) -> Float[Array, " pair"]:
        """Beam of the short baselines at distances along l and m [rad]; 0 beyond its image."""
        place = apart.T / self.wide_pixel + WIDE_SIZE // 2
        return map_coordinates(self.wide, place, order=1, mode="constant")

    def ending(self, beam: int, start: float, end: float) -> Float[Array, "l m"]:
        """Return a beam that ends smoothly between the distances ``start`` and ``end`` [pixels]."""
        x = np.arange(SIZE) - SIZE // 2
        window = smooth_step(np.hypot(x[:, None], x[None, :]), start, end)
        return self.images[beam] * window


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
        Direction cosines at which the beams are accumulated.
    filters
        Direction cosines and spectral index of the source whose filter each beam has.
    mixtures
        Mixture of beams of each source.
    shortest, longest
        Range of the baselines that are used [wavelengths].
    pixel
        Width of the pixels [rad].
    """

    nodes: Float[Array, "beam 2"]
    filters: tuple[SeenAs, ...]
    mixtures: tuple[Mixture, ...]
    shortest: float
    longest: float
    pixel: float

    @classmethod
    def around(
        cls, galaxies: Galaxies, response: Response, shortest: float, longest: float, pixel: float
    ) -> Self:
        """Plan the beams of some sources."""
        lattice, nearest = directions(np.column_stack([galaxies.l, galaxies.m]))
        nodes: list[Float[Array, " 2"]] = []
        filters: list[SeenAs] = []
        mixtures: dict[int, Mixture] = {}
        for k, node in enumerate(lattice):
            members = np.flatnonzero(nearest == k)
            near = galaxies.select(members)
            shared = response.shared_filters(near, shortest, longest, power=2)
            numbers = range(len(nodes), len(nodes) + len(shared.chosen))
            nodes += [node] * len(numbers)
            filters += [seen_as(near, source) for source in shared.chosen.tolist()]
            for member, shares in zip(members.tolist(), shared.coefficients.T, strict=True):
                mixtures[member] = Mixture.from_shares(numbers, shares)
        ordered = tuple(mixtures[source] for source in range(len(galaxies)))
        return cls(np.array(nodes), tuple(filters), ordered, shortest, longest, pixel)


class BeamAccumulator(BlockAccumulator[Beams]):
    """Dirty beams of a plan.

    Parameters
    ----------
    plan
        Directions, filters, baselines and pixels.
    response
        Spectrum and attenuation of the sources.
    gridding
        Accuracy and resources.
    on_samples
        Function called after each beam with the number of samples over that of the beams.
    """

    def __init__(
        self,
        plan: BeamPlan,
        response: Response,
        gridding: Gridding,
        on_samples: Callable[[float], None] | None = None,
    ) -> None:
        super().__init__(plan.shortest, plan.longest, gridding)
        self._plan, self._response, self._gridding = plan, response, gridding
        self._on_samples = on_samples
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
        return Beams(self._images, plan.mixtures, plan.pixel, self._wide, self._wide_pixel)

    def add_block(self, samples: Samples) -> None:
        """Image the weights of a block for every beam."""
        plan, response, gridding = self._plan, self._response, self._gridding
        samples = in_uv_order(samples, gridding.executor)
        unit = (samples.weights * response.gain(samples.frequency) ** 2).astype(np.complex64)

        def image(task: tuple[int, slice]) -> tuple[int, Float[Array, "l m"], int]:
            beam, rows = task
            if beam == _WIDE:
                return beam, self._wide_image(samples.uvw[rows], unit[rows]), 0
            # Phased to the direction itself a beam has its centre there.
            plane = TangentPlane.at(samples.uvw[rows], *plan.nodes[beam])
            matched = response.matched_filter(samples.select(rows), *plan.filters[beam])
            part = plane.beam(unit[rows] * matched**2, SIZE, plan.pixel, gridding.epsilon)
            return beam, part, len(plane.phase)

        beams = [_WIDE, *range(len(plan.nodes))]
        tasks = [(beam, rows) for beam in beams for rows in slabs(len(samples))]
        executor = gridding.executor_for(SIZE, len(samples))
        for beam, part, count in executor.map(image, tasks):
            total = self._wide if beam == _WIDE else self._images[beam]
            total += part
            if self._on_samples is not None:
                self._on_samples(count / len(plan.nodes))

    def _wide_image(
        self, uvw: Float[Array, "sample 3"], unit: Complex[Array, " sample"]
    ) -> Float[Array, "l m"]:
        """Image the short baselines among some."""
        short = np.hypot(uvw[:, 0], uvw[:, 1]) < WIDE_BAND * self._plan.longest
        plane = TangentPlane.at(uvw[short], *self._plan.nodes[0])
        return plane.beam(unit[short], WIDE_SIZE, self._wide_pixel, self._gridding.epsilon)


def gather_beams(
    observation: Observation, plan: BeamPlan, response: Response, gridding: Gridding
) -> Beams:
    """Read the visibilities once, for the beams only."""
    (beams,) = accumulate(observation, [BeamAccumulator(plan, response, gridding)])
    return beams
