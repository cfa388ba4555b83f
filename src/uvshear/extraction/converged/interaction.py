"""The interaction of sources between two major cycles: the changes of all models, convolved with the beam.

The change of every model since the last major cycle, convolved with the beam, is kept as an image (``change_image``) on
pixels twice as wide as the finest: a galaxy has hardly any power on the baselines that are lost, and the product of two
galaxies even less. The image ends smoothly ``END`` pixels from a source that has changed. If all baselines are used,
the beam farther away is the plateau of the short baselines, which is flat over a facet and couples fluxes. The two
parts together are the whole beam, so that the joint likelihood has a maximum; the transform of a truncated beam would
not be positive. The next major cycle is exact everywhere.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import fft, sparse
from scipy.spatial import cKDTree

from uvshear.extraction.converged.beams import SIZE, Beams, coarse_spectrum, power_of
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.galaxy import Profile
from uvshear.geometry.ellipticity import quadratic_form_of
from uvshear.imaging.bands import Band
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import BeamPlane
from uvshear.numerics.half_plane import half_plane
from uvshear.predict.rendering import smooth_step, transform_on_stamp
from uvshear.typing import Array, Complex, Float

WINDOW = SIZE // 2
"""Side of the image of one change [coarse pixels]."""

START, END = 0.25 * WINDOW, 0.47 * WINDOW
"""Distances between which the image is tapered to zero [coarse pixels]: 50 and 93 arcsec for SKA-Mid."""

FAR = 2.7
"""Distance beyond which fluxes are not coupled, over ``END``: the plateau of SKA-Mid's beam is down to 1e-3 there."""


@dataclass(frozen=True)
class PlacedSource:
    """Parameters of a source of the sky for the interaction.

    Parameters
    ----------
    flux
        Flux in the common spectrum of the sources [Jy].
    offset
        Offset from the centre of its cutout [rad].
    ellipticity
        Complex ellipticity.
    scale_length
        Scale length [rad].
    """

    flux: float
    offset: tuple[float, float]
    ellipticity: complex
    scale_length: float


class Interaction:
    """The beam that propagates the change of one source to another; it does not depend on the changes.

    Parameters
    ----------
    plan
        Plan of the last major cycle.
    beams
        Dirty beams over the field.
    profile
        Brightness profile of the sources.
    """

    def __init__(self, plan: MajorCyclePlan, beams: Beams, profile: Profile) -> None:
        self._plan, self._beams, self._profile = plan, beams, profile
        self._band = Band(0.0, plan.bands[0].longest / 2, 2 * plan.pixel)
        self._far = self._far_couplings()
        self._spectra: dict[int, Float[Array, "u v"]] = {}
        self._planes: dict[tuple[int, float], BeamPlane] = {}
        self._own: dict[tuple[int, Cutout], Float[Array, " cell"]] = {}

    @property
    def plan(self) -> MajorCyclePlan:
        """Plan of the last major cycle."""
        return self._plan

    @property
    def beams(self) -> Beams:
        """Dirty beams over the field."""
        return self._beams

    @property
    def reach(self) -> float:
        """Distance beyond which only fluxes are coupled [rad]."""
        return END * self._band.pixel

    @property
    def far(self) -> sparse.csr_matrix:
        """Part of the coupling of fluxes that the image does not hold [Jy^-2]."""
        return self._far

    def render(
        self, source: int, before: PlacedSource, after: PlacedSource
    ) -> tuple[float, Float[Array, "l m"]]:
        """Return the change of a source in units of the noise, and that of the dirty image around it."""
        change = self._transform(after) - self._transform(before)
        seen = change * self._spectrum(int(self._beams.nearest[source]))
        # This is half of the plane: the column v = 0 counts once, as does the last.
        product = (seen * change.conj()).real
        power = 2 * product.sum(dtype=float) - product[:, [0, -1]].sum(dtype=float)
        distance = math.sqrt(max(float(power), 0.0)) / WINDOW
        return distance, fft.fftshift(fft.irfft2(seen, s=(WINDOW, WINDOW), overwrite_x=True))

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

    def plane_around(self, source: int) -> BeamPlane:
        """Cells and power of the beam of a source on all baselines of the interaction, for sources that overlap."""
        return self._plane(int(self._beams.nearest[source]), self._band.longest)

    def short_plane_around(self, source: int) -> BeamPlane:
        """Cells and power of the shorter half of these baselines, which is enough for two separate galaxies.

        A quarter of the longest baseline is 2.1 times 1/(2 pi alpha) of the faintest; the product of two discs is
        down to a hundredth there.
        """
        return self._plane(int(self._beams.nearest[source]), self._band.longest / 2)

    def _ending(self, node: int) -> Float[Array, "l m"]:
        return self._beams.ending(node, 2 * START, 2 * END)

    def _plane(self, node: int, longest: float) -> BeamPlane:
        if (node, longest) not in self._planes:
            cells = half_plane(WINDOW, self._band.pixel, 0.0, longest)
            multiplicity = (cells.multiplicity / WINDOW**2).astype(np.float32)
            power = self._spectrum(node)[cells.index] * multiplicity
            self._planes[node, longest] = BeamPlane(cells.uv.astype(np.float32), power)
        return self._planes[node, longest]

    def _far_couplings(self) -> sparse.csr_matrix:
        place = self._plan.centres
        if self._plan.shortest > 0:
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

    def _transform(self, source: PlacedSource) -> Complex[Array, "u v"]:
        form = quadratic_form_of(source.ellipticity, source.scale_length)
        spectrum = transform_on_stamp(form, source.offset, WINDOW, self._band, self._profile)
        return spectrum * np.float32(source.flux)

    def _spectrum(self, node: int) -> Float[Array, "u v"]:
        if node not in self._spectra:
            self._spectra[node] = coarse_spectrum(self._ending(node))
        return self._spectra[node]
