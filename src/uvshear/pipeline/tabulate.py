"""Results of an extraction as the table of shapes and as the catalogue of the fitted sky."""

import numpy as np
from astropy.table import Table
from scipy.spatial import cKDTree

from uvshear.extraction import Extracted, Field, Model
from uvshear.geometry.directions import PhaseCentre, equatorial
from uvshear.io.catalogue import Catalogue
from uvshear.io.shapes import shapes_table
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.table_row import shape_values
from uvshear.typing import Array, Float

_WORD = f"U{max(len(flag.word) for flag in FitFlag)}"


def tabulate_shapes(
    sources: Catalogue, field: Field, extracted: Extracted, phase_centre: PhaseCentre, model: Model
) -> Table:
    """Return the table of shapes, with one row for every source of the catalogue, in its order."""
    # Of a large catalogue, only the few sources that were measured have numbers of their own.
    nothing = shape_values(ShapeMeasurement.failed(FitFlag.OUTSIDE_FIELD), model.population)
    columns = {name: np.full(len(sources), value) for name, value in nothing.items()}
    flags = np.array([flag.word for flag in field.flags], dtype=_WORD)
    for source, result in extracted.measurements.items():
        flags[source] = result.flag.word
        for name, value in shape_values(result, model.population).items():
            columns[name][source] = value
    columns |= {
        "id": sources.identifier,
        "l": field.l,
        "m": field.m,
        "flux": sources.flux,
        "neighbour_distance": _neighbour_distances(field),
        "flag": flags,
    }
    if sources.ra is not None and sources.dec is not None:
        columns |= {"ra": sources.ra, "dec": sources.dec}
    return shapes_table(columns, phase_centre, record=extracted.record)


def _neighbour_distances(field: Field) -> Float[Array, " source"]:
    """Distance of each modelled source from the nearest other one [rad]; infinite where there is none."""
    place = np.column_stack([field.l, field.m])
    distance = np.full(len(place), np.nan)
    distance[field.modelled] = np.inf
    if len(field.modelled) > 1:
        nearest, _ = cKDTree(place[field.modelled]).query(place[field.modelled], k=2)
        distance[field.modelled] = nearest[:, 1]
    return distance


def catalogue_of_sky(
    sources: Catalogue, field: Field, extracted: Extracted, phase_centre: PhaseCentre
) -> Catalogue:
    """Return the sources that were subtracted, with their fitted positions, fluxes, sizes and ellipticities.

    Sources without flux are not in it.
    """
    found = extracted.sky
    there = field.modelled[found.flux[field.modelled] > 0]
    sky = found.select(there)
    ra, dec = equatorial(phase_centre, sky.l, sky.m)
    return Catalogue(
        identifier=sources.identifier[there],
        flux=sky.flux,
        spectral_index=sky.spectral_index,
        ra=ra,
        dec=dec,
        scale_length=sky.scale_length,
        ellipticity=sky.ellipticity,
        is_point=sky.scale_length == 0,
        reference_frequency=sky.reference_frequency,
        field_centre=phase_centre,
    )
