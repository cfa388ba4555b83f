"""Updates of the sky model."""

from collections.abc import Mapping
from dataclasses import replace

from uvshear.extraction.field import Field
from uvshear.galaxy import Galaxies
from uvshear.shapes.measurement import GalaxyFit


def with_fitted(sky: Galaxies, field: Field, fits: Mapping[int, GalaxyFit]) -> Galaxies:
    """Replace sources of the sky by fitted galaxies, given by index of the catalogue; the others stay as they are."""
    l, m, flux = sky.l.copy(), sky.m.copy(), sky.flux.copy()
    scale_length, ellipticity = sky.scale_length.copy(), sky.ellipticity.copy()
    for source, fit in fits.items():
        l[source] = field.l[source] + fit.offset[0]
        m[source] = field.m[source] + fit.offset[1]
        flux[source], scale_length[source] = fit.flux, fit.scale_length
        ellipticity[source] = fit.ellipticity
    return replace(sky, l=l, m=m, flux=flux, scale_length=scale_length, ellipticity=ellipticity)
