"""The table of measured shapes: its columns, their units, and how it is written and read."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from astropy import units
from astropy.table import Column, Table

from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre, equatorial, local_north
from uvshear.geometry.ellipticity import lensing_components, position_angle, to_local_north
from uvshear.io.provenance import Provenance, ascii_text
from uvshear.io.shape_checks import check_shapes, numbers
from uvshear.io.tables import read_table, write_table
from uvshear.typing import Array, Float, Shaped


@dataclass(frozen=True)
class ShapeColumn:
    """A column of a table of shapes.

    Parameters
    ----------
    description
        Meaning of the column.
    unit
        Unit in files.
    inside
        Value of that unit in SI or radians, the units of the package.
    """

    description: str
    unit: str | None = None
    inside: float = 1.0


_FRAME = "axes l East, m North of the phase centre"
_LOCAL = "axes local East and North"

COLUMNS: Mapping[str, ShapeColumn] = {
    "id": ShapeColumn("identifier of the source in the catalogue"),
    "ra": ShapeColumn("right ascension in the catalogue, ICRS", "deg", float(np.pi / 180)),
    "dec": ShapeColumn("declination in the catalogue, ICRS", "deg", float(np.pi / 180)),
    "l": ShapeColumn("direction cosine to the East", "rad"),
    "m": ShapeColumn("direction cosine to the North", "rad"),
    "flux": ShapeColumn("flux density in the catalogue", "uJy", MICROJANSKY),
    "e1": ShapeColumn(f"posterior mean of e1; {_FRAME}"),
    "e2": ShapeColumn(f"posterior mean of e2; {_FRAME}"),
    "e1_err": ShapeColumn("posterior standard deviation of e1"),
    "e2_err": ShapeColumn("posterior standard deviation of e2"),
    "e12_cov": ShapeColumn("posterior covariance of e1 and e2"),
    "e_sigma": ShapeColumn("1D standard deviation of e, det(covariance)^(1/4)"),
    "weight": ShapeColumn("lensfit's weight; 0 unless the flag is ok"),
    "snr": ShapeColumn("flux over its error at fixed shape, natural weights"),
    "scale_length": ShapeColumn("posterior mean of the scale length", "arcsec", ARCSEC),
    "scale_length_err": ShapeColumn("standard deviation of the scale length", "arcsec", ARCSEC),
    "flux_fit": ShapeColumn(
        "fitted flux density at the reference frequency of the catalogue", "uJy", MICROJANSKY
    ),
    "flux_fit_err": ShapeColumn("standard deviation of flux_fit", "uJy", MICROJANSKY),
    "dl": ShapeColumn("fitted minus catalogue position, to the East", "arcsec", ARCSEC),
    "dm": ShapeColumn("fitted minus catalogue position, to the North", "arcsec", ARCSEC),
    "flag": ShapeColumn("outcome of the fit: ok, or the reason why there is no usable shape"),
    "g1": ShapeColumn(f"e1 in TreeCorr's convention for (RA, Dec); {_LOCAL}"),
    "g2": ShapeColumn(f"e2 in TreeCorr's convention for (RA, Dec); {_LOCAL}"),
    "position_angle": ShapeColumn(
        "long axis from North through East, in [0, 180)", "deg", float(np.pi / 180)
    ),
    "detection": ShapeColumn(
        "significance of the source on the baselines that were used, sqrt(2 Delta log L) against no source"
    ),
    "resolved": ShapeColumn(
        "significance of the extent, sqrt(2 Delta log L) against a point source"
    ),
    "neighbour_distance": ShapeColumn(
        "distance to the nearest other source that is modelled", "arcsec", ARCSEC
    ),
    "error_widening": ShapeColumn("error of e over what it would be if the neighbours were known"),
    "remaining_change": ShapeColumn(
        "change of the model that another major cycle would bring, in units of the noise"
    ),
}
"""Every column of a table of shapes, in order."""

DERIVED = ("ra", "dec", "g1", "g2", "position_angle")
"""Columns that :func:`shapes_table` computes from (l, m) and (e1, e2)."""


def shapes_table(
    values: Mapping[str, Shaped[Array, " source"]],
    phase_centre: PhaseCentre,
    provenance: Provenance | None = None,
    *,
    record: Mapping[str, object] | None = None,
) -> Table:
    """Return a table of shapes in the units of files.

    Parameters
    ----------
    values
        Every column except those of :data:`DERIVED`, in SI and radians. ``ra`` and ``dec`` are taken if they are given.
    phase_centre
        Direction of l = m = 0.
    provenance
        Origin of the table, for its metadata.
    record
        Record of the extraction, which becomes text in ``meta["extract"]``.
    """
    needed = [name for name in COLUMNS if name not in DERIVED]
    if lacking := [name for name in needed if name not in values]:
        raise InputError(f"a table of shapes lacks {', '.join(lacking)}")
    l, m = values["l"], values["m"]
    ra, dec = equatorial(phase_centre, l, m)
    local = to_local_north(values["e1"] + 1j * values["e2"], local_north(phase_centre, l, m))
    g1, g2 = lensing_components(local)
    derived = {"ra": ra, "dec": dec, "g1": g1, "g2": g2, "position_angle": position_angle(local)}
    everything = derived | dict(values)
    table = Table()
    for name, column in COLUMNS.items():
        inside: Array = everything[name]
        outside = inside / column.inside if column.inside != 1 else inside
        table[name] = Column(outside, unit=column.unit, description=column.description)
    table.meta["ra0_deg"] = float(np.degrees(phase_centre.ra))
    table.meta["dec0_deg"] = float(np.degrees(phase_centre.dec))
    if record is not None:
        table.meta["extract"] = ascii_text(dict(record))
    if provenance is not None:
        table.meta.update(provenance.metadata())
    return table


def write_shapes(path: Path, table: Table, *, overwrite: bool = False) -> None:
    """Write shapes as ECSV or FITS by extension; both keep units, descriptions and provenance."""
    write_table(path, table, overwrite=overwrite)


def read_shapes(path: Path) -> Table:
    """Read a table of shapes, and convert its columns to the units of :data:`COLUMNS`."""
    table = read_table(path, "table of shapes written by `uvshear measure`")
    if len(table) == 0:
        raise InputError(f"{path}: has no rows; a table of at least one shape is needed")
    for name in table.colnames:
        expected = COLUMNS.get(name)
        if expected is not None and expected.unit is not None and table[name].unit is not None:
            try:
                table[name].convert_unit_to(expected.unit)
            except (units.UnitsError, TypeError, ValueError) as error:
                raise InputError(
                    f"{path}: column '{name}' is in '{table[name].unit}', which cannot be converted to"
                    f" '{expected.unit}'"
                ) from error
    check_shapes(table, str(path))
    phase_centre_of(table, f"{path}:")
    return table


def inside(table: Table, name: str) -> Float[Array, " source"]:
    """Return a column of a table of shapes in SI and radians, NaN where it is empty."""
    if name not in table.colnames:
        raise InputError(
            f"the table of shapes has no column '{name}'; one written by `uvshear measure` has it"
        )
    return numbers(table[name], f"the table of shapes: column '{name}'") * COLUMNS[name].inside


def metadata(table: Table) -> dict[str, object]:
    """Return the metadata of a table by name in lower case; FITS has names in capitals."""
    return {str(name).lower(): value for name, value in table.meta.items()}


def extraction_record(table: Table) -> Mapping[str, object]:
    """Return the record of the extraction from a table of shapes; empty where it has none."""
    try:
        record = json.loads(str(metadata(table).get("extract", "{}")))
    except (ValueError, RecursionError):
        return {}
    return record if isinstance(record, dict) else {}


def averages_cells(table: Table) -> bool:
    """Tell whether the shapes were measured on the paper's facets, which average in cells."""
    return extraction_record(table).get("averages_cells") is True


def phase_centre_of(table: Table, name: str = "the table of shapes") -> PhaseCentre:
    """Return the phase centre of the axes l and m of a table of shapes, which messages call by its name."""
    known = metadata(table)
    try:
        ra, dec = (math.radians(float(str(known[name]))) for name in ("ra0_deg", "dec0_deg"))
        if not (math.isfinite(ra) and abs(dec) <= math.pi / 2):
            raise ValueError("no direction")
    except (KeyError, ValueError, OverflowError) as error:
        raise InputError(
            f"{name} lacks its phase centre (ra0_deg and dec0_deg in its metadata), which is needed to rotate"
            " ellipticities to local North; a table written by `uvshear measure` has it"
        ) from error
    return PhaseCentre(ra, dec)
