"""One galaxy observed with an array like SKA-Mid or MeerKAT, as an estimator is given it."""

from dataclasses import replace

import numpy as np

from uvshear.bias.mock_facets import FacetSimulator
from uvshear.constants import ARCSEC
from uvshear.galaxy import DiscEllipticityPrior, Exponential
from uvshear.imaging.cutout import cutout
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.source_facet import SourceFacet, noise_named

FLUX = 5e-5


def source_facet(
    longest=100e3,
    *,
    e=0.3 - 0.1j,
    alpha=ARCSEC,
    noise=1.0,
    name=(1, 2),
    flux=FLUX,
    shift=(0.0, 0.0),
):
    """A galaxy of SNR 300 or so; the array ends at ``longest`` [wavelengths], the noise may be scaled."""
    width = 45 * ARCSEC
    cells = cutout(100, width / 100, 0.0, 100e3)
    distance = np.hypot(*cells.uv.T)
    power = cells.multiplicity * np.where(distance < longest, 1e11 * np.exp(-distance / 15e3), 0.0)
    first, second = np.random.default_rng(4).standard_normal((2, len(power)))
    galaxy = GalaxyFit(flux, np.array(shift), e, alpha, 0.0)
    drawn = noise * (first + 1j * second)
    return SourceFacet(
        facet=FacetSimulator(cells, power).facet(galaxy, Exponential(), drawn),
        cells=cells,
        prior=ShapePrior(float(np.log(ARCSEC)), 0.3),
        flux=flux,
        profile=Exponential(),
        population=DiscEllipticityPrior(),
        draw_noise=noise_named(name, len(power)),
    )


def in_other_unit(source, unit):
    """The same source with a unit of flux of its own, and the beam that it shares with the other."""
    facet = source.facet.in_other_unit(unit)
    return replace(source, facet=facet, unit=unit, beam=source.facet.power)
