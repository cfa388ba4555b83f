"""What sources do to one another between two visits of the visibilities.

The change of every model since the last visit, convolved with the beam, is kept as an image on pixels twice as
wide as the finest: a galaxy is hardly seen on the baselines that are lost, less so in the product of two. The image
ends smoothly ``END`` pixels from a source that has changed. Farther away, if all baselines take part, what is left of
the beam is the plateau of the short ones, flat over a facet: it couples fluxes. Both parts together are the beam, so
that the common likelihood has a maximum: a beam cut off would not be positive. The next visit is exact everywhere.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import fft, sparse
from scipy.spatial import cKDTree

from uvshear.extraction.converged.beams import SIZE, Beams, coarse_spectrum, power_of
from uvshear.extraction.converged.plan import VisitPlan
from uvshear.galaxy import Profile
from uvshear.geometry.ellipticity import quadratic_form_of
from uvshear.imaging.bands import Band
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import BeamPlane
from uvshear.numerics.half_plane import half_plane
from uvshear.predict.rendering import smooth_step, transform_on_stamp
from uvshear.typing import Array, Complex, Float

WINDOW = SIZE // 2
"""Coarse pixels to a side."""

START, END = 0.25 * WINDOW, 0.47 * WINDOW
"""Distances between which the image ends [coarse pixels]: 50 and 93 arcsec for SKA-Mid."""

FAR = 2.7
"""Distance beyond which fluxes are not coupled, over ``END``: the plateau of SKA-Mid's beam is down to 1e-3."""


@dataclass(frozen=True)
class Source:
    """One galaxy of the sky as the interaction sees it: its offset is from the place of its cutout [rad].

    ``flux`` is that of the expansion's common spectrum.
    """

    flux: float
    offset: tuple[float, float]
    ellipticity: complex
    scale_length: float


class Interaction:
    """The change of the sky since a visit, seen through the beam."""

    def __init__(self, plan: VisitPlan, beams: Beams, profile: Profile) -> None:
        self._plan, self._beams, self._profile = plan, beams, profile
        self._places = plan.place // 2
        margin = SIZE // 2
        self._origin = self._places.min(axis=0) - margin
        shape = self._places.max(axis=0) + margin + 1 - self._origin
        # Zeros that nobody writes take no memory: places without sources cost nothing.
        self._image = np.zeros(tuple(shape), np.float32)
        longest = plan.bands[0].longest / 2
        self._band = Band(0.0, longest, 2 * plan.pixel)
        self._far = self._far_couplings(plan)
        self._plateau = np.zeros(len(plan.cutouts))
        self._spectra: dict[int, Float[Array, "u v"]] = {}
        self._planes: dict[tuple[int, float], BeamPlane] = {}
        self._own: dict[tuple[int, Cutout], Float[Array, " cell"]] = {}

    @property
    def reach(self) -> float:
        """Distance at which only fluxes are coupled [rad]."""
        return END * self._band.pixel

    @property
    def far(self) -> sparse.csr_matrix:
        """Part of the coupling of fluxes that the image does not hold [Jy^-2]."""
        return self._far

    def change_flux(self, changes: Float[Array, " source"]) -> None:
        """Tell how far the flux of every source is from that of the last visit [Jy]."""
        self._plateau = self._far @ changes

    def rendered(
        self, source: int, before: Source, after: Source
    ) -> tuple[float, Float[Array, "l m"]]:
        """Change of a source in units of the noise, and of the dirty image around it."""
        change = self._transform(after) - self._transform(before)
        seen = change * self._spectrum(int(self._beams.nearest[source]))
        # Half of the plane: the column v = 0 counts once, as does the last.
        product = (seen * change.conj()).real
        power = 2 * product.sum(dtype=float) - product[:, [0, -1]].sum(dtype=float)
        distance = math.sqrt(max(float(power), 0.0)) / WINDOW
        return distance, fft.fftshift(fft.irfft2(seen, s=(WINDOW, WINDOW), overwrite_x=True))

    def add(self, source: int, change: Float[Array, "l m"]) -> None:
        """Put what was rendered into the image."""
        i, j = self._places[source] - self._origin - WINDOW // 2
        self._image[i : i + WINDOW, j : j + WINDOW] += change

    def subtract_from(self, facet: Complex[Array, " cell"], source: int) -> None:
        """Take from a residual facet (not yet recentred) what all sources have changed, the source's own too."""
        cutout: Cutout = self._plan.cutouts[source]
        half = cutout.size // 2
        i, j = self._places[source] - self._origin - half // 2
        cutout.add_coarse(self._image[i : i + half, j : j + half], -1.0, facet)
        if cutout.shortest <= 0:
            facet[cutout.origin] -= self._plateau[source]

    def own_power(self, source: int) -> Float[Array, " cell"]:
        """Power of the beam with which the image holds a source's own change, on the cells of its facet."""
        cutout, node = self._plan.cutouts[source], int(self._beams.nearest[source])
        if (node, cutout) not in self._own:
            taper = smooth_step(np.hypot(*cutout.uv.T), self._band.longest, 0.5 / self._band.pixel)
            own = np.zeros(len(taper), np.float32)
            resolved = cutout.coarse_cells[0]
            own[resolved] = (taper * power_of(self._ending(node), cutout))[resolved]
            self._own[node, cutout] = own
        return self._own[node, cutout]

    def _ending(self, node: int) -> Float[Array, "l m"]:
        return self._beams.ending(node, 2 * START, 2 * END)

    def plane(self, node: int) -> BeamPlane:
        """Cells and power of a beam, all baselines that the interaction knows: for sources that overlap."""
        return self._plane(node, self._band.longest)

    def short_plane(self, node: int) -> BeamPlane:
        """Cells and power of the shorter half of these baselines: more than that two galaxies apart hardly share.

        A quarter of the longest baseline is 2.1 times 1/(2 pi alpha) of the faintest; the product of two discs is
        down to a hundredth there.
        """
        return self._plane(node, self._band.longest / 2)

    def _plane(self, node: int, longest: float) -> BeamPlane:
        if (node, longest) not in self._planes:
            cells = half_plane(WINDOW, self._band.pixel, 0.0, longest)
            multiplicity = (cells.multiplicity / WINDOW**2).astype(np.float32)
            power = self._spectrum(node)[cells.index] * multiplicity
            self._planes[node, longest] = BeamPlane(cells.uv.astype(np.float32), power)
        return self._planes[node, longest]

    def _far_couplings(self, plan: VisitPlan) -> sparse.csr_matrix:
        place = plan.place * plan.pixel + plan.offset
        if plan.shortest > 0:
            return sparse.csr_matrix((len(place), len(place)))
        pairs = cKDTree(place).query_pairs(FAR * self.reach, output_type="ndarray")
        apart = place[pairs[:, 1]] - place[pairs[:, 0]]
        distance = np.hypot(*apart.T)
        pixel = self._band.pixel
        kept = distance > START * pixel
        left = 1 - smooth_step(distance[kept], START * pixel, END * pixel)
        value = (self._beams.plateau(apart[kept]) * left).astype(float)
        (i, j), count = pairs[kept].T, len(place)
        half = sparse.csr_matrix((value, (i, j)), shape=(count, count))
        return half + half.T

    def _transform(self, source: Source) -> Complex[Array, "u v"]:
        form = quadratic_form_of(source.ellipticity, source.scale_length)
        spectrum = transform_on_stamp(form, source.offset, WINDOW, self._band, self._profile)
        return spectrum * np.float32(source.flux)

    def _spectrum(self, node: int) -> Float[Array, "u v"]:
        if node not in self._spectra:
            self._spectra[node] = coarse_spectrum(self._ending(node))
        return self._spectra[node]
