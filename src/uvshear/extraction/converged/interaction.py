"""The interaction of sources between two major cycles: the changes of all models, convolved with the beam.

The change of every model since the last major cycle, convolved with the beam, is kept as an image (``change_image``) on
pixels twice as wide as the finest: a galaxy has hardly any power on the baselines that are lost, and the product of two
galaxies even less. The image ends smoothly ``END`` pixels from a source that has changed. If all baselines are used,
the beam farther away is the plateau of the short baselines, which is flat over a facet and couples fluxes. The two
parts together are the whole beam, so that the joint likelihood has a maximum; the transform of a truncated beam would
not be positive. The next major cycle is exact everywhere.
"""

import math
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from uvshear.extraction.converged.beams import SIZE, Beams, coarse_spectrum, power_of
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.galaxy import Profile
from uvshear.geometry.ellipticity import quadratic_form_of
from uvshear.imaging.bands import Band
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import BeamPlane
from uvshear.numerics.half_plane import HalfPlane, half_plane
from uvshear.numerics.real_transforms import image_into
from uvshear.predict import kernels
from uvshear.predict.rendering import smooth_step, stamp_plane
from uvshear.typing import Array, Float

WINDOW = SIZE // 2
"""Side of the image of one change [coarse pixels]."""

START, END = 0.25 * WINDOW, 0.47 * WINDOW
"""Distances between which the image is tapered to zero [coarse pixels]: 50 and 93 arcsec for SKA-Mid."""

_ALTERNATING = (-1.0) ** np.arange(WINDOW).astype(np.float32)
"""Factors of the cells along an axis that move the origin of the transform to the centre of the window."""

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
        self._endings: dict[int, Float[Array, "l m"]] = {}
        self._spectra: dict[int, Float[Array, "u v"]] = {}
        self._planes: dict[tuple[int, float], Float[Array, " cell"]] = {}
        self._half_planes: dict[float, HalfPlane] = {}
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
        self, source: int, before: PlacedSource, after: PlacedSource, image: Float[Array, "l m"]
    ) -> float:
        """Write the change of the dirty image around a source that changes.

        Parameters
        ----------
        source
            Number of the source.
        before, after
            Parameters of the source.
        image
            The change of the dirty image is written into it: a square of ``WINDOW`` coarse pixels.

        Returns
        -------
        float
            Change of the source in units of the noise.
        """
        plane = stamp_plane(WINDOW, self._band)
        spectrum = np.empty((len(plane.u), len(plane.v)), np.complex64)
        beam = self._beams.mixtures[source].mixed(self._spectrum)
        power = kernels.plane_change(
            self._seen(after), self._seen(before), plane.taper, plane.reach, beam, spectrum
        )
        image_into(spectrum, image)
        return math.sqrt(max(float(power), 0.0)) / WINDOW

    def own_power(self, source: int) -> Float[Array, " cell"]:
        """Power of the beam with which the image holds a source's own change, on the cells of its facet."""
        of_beam = partial(self._own_power, self._plan.cutouts[source])
        return self._beams.mixtures[source].mixed(of_beam)

    def plane_around(self, source: int) -> BeamPlane:
        """Cells and power of the beam of a source on all baselines of the interaction, for sources that overlap."""
        return self._plane(source, self._band.longest)

    def short_plane_around(self, source: int) -> BeamPlane:
        """Cells and power of the shorter half of these baselines, which is enough for two separate galaxies.

        A quarter of the longest baseline is 2.1 times 1/(2 pi alpha) of the faintest; the product of two discs is
        down to a hundredth there.
        """
        return self._plane(source, self._band.longest / 2)

    def work_out_planes(self) -> None:
        """Compute what :meth:`short_plane_around` needs once, before several workers ask for it."""
        for beam in range(len(self._beams.images)):
            self._plane_power(self._band.longest / 2, beam)

    def _own_power(self, cutout: Cutout, beam: int) -> Float[Array, " cell"]:
        if (beam, cutout) not in self._own:
            self._own[beam, cutout] = self._found_own_power(beam, cutout)
        return self._own[beam, cutout]

    def _found_own_power(self, beam: int, cutout: Cutout) -> Float[Array, " cell"]:
        taper = smooth_step(np.hypot(*cutout.uv.T), self._band.longest, 0.5 / self._band.pixel)
        own = np.zeros(len(taper), np.float32)
        resolved = cutout.resolved_cells
        own[resolved] = (taper * power_of(self._ending(beam), cutout))[resolved]
        return own

    def _ending(self, beam: int) -> Float[Array, "l m"]:
        if beam not in self._endings:
            self._endings[beam] = self._beams.ending(beam, 2 * START, 2 * END)
        return self._endings[beam]

    def _plane(self, source: int, longest: float) -> BeamPlane:
        of_beam = partial(self._plane_power, longest)
        return BeamPlane(self._cells(longest).uv, self._beams.mixtures[source].mixed(of_beam))

    def _plane_power(self, longest: float, beam: int) -> Float[Array, " cell"]:
        if (beam, longest) not in self._planes:
            cells = self._cells(longest)
            multiplicity = (cells.multiplicity / WINDOW**2).astype(np.float32)
            self._planes[beam, longest] = self._spectrum(beam)[cells.index] * multiplicity
        return self._planes[beam, longest]

    def _cells(self, longest: float) -> HalfPlane:
        if longest not in self._half_planes:
            cells = half_plane(WINDOW, self._band.pixel, 0.0, longest)
            self._half_planes[longest] = replace(cells, uv=cells.uv.astype(np.float32))
        return self._half_planes[longest]

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

    def _seen(self, source: PlacedSource) -> tuple[Array, Array, Array]:
        """Return the envelope of a source, and its phases along both axes, the first times its flux."""
        plane = stamp_plane(WINDOW, self._band)
        form = quadratic_form_of(source.ellipticity, source.scale_length)
        along_u, along_v = plane.phases(source.offset)
        envelope = self._profile.envelope(plane.argument(form))
        return (
            envelope,
            along_u * (np.float32(source.flux) * _ALTERNATING),
            along_v * _ALTERNATING[: len(along_v)],
        )

    def _spectrum(self, beam: int) -> Float[Array, "u v"]:
        if beam not in self._spectra:
            self._spectra[beam] = coarse_spectrum(self._ending(beam))
        return self._spectra[beam]
