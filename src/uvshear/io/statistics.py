"""The file beside a table of shapes that holds what estimators of the shear need of every source."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from astropy.table import Column, Table

from uvshear.errors import InputError
from uvshear.io.tables import read_table, write_table
from uvshear.shapes.source_facet import Kept, Statistic
from uvshear.typing import Array


def statistics_path(shapes: Path) -> Path:
    """Name of the file that goes with a table of shapes."""
    return shapes.with_name(f"{shapes.stem}.stats.fits")


def statistics_table(
    shapes: Table, estimators: Sequence[Statistic], kept: Mapping[int, Kept]
) -> Table:
    """Table of what was kept for estimators, a row for every row of the shapes; NaN or an empty array where nothing is.

    Parameters
    ----------
    kept
        Statistics by the number of the row.
    """
    table = Table({"id": shapes["id"]})
    table.meta["estimators"] = ",".join(getattr(statistic, "name", "") for statistic in estimators)
    for estimator in estimators:
        for name, column in estimator.columns.items():
            values = _values(name, len(shapes), kept)
            table[name] = Column(values, unit=column.unit, description=column.description)
    return table


def _values(name: str, rows: int, kept: Mapping[int, Kept]) -> Array:
    known = {source: numbers[name] for source, numbers in kept.items() if name in numbers}
    arrays = [value for value in known.values() if isinstance(value, np.ndarray)]
    values: Array = np.full(rows, np.nan)
    if arrays:
        values = np.empty(rows, object)
        values[:] = [arrays[0][:0]] * rows
    for source, value in known.items():
        values[source] = value
    return values


def write_statistics(
    path: Path, table: Table, provenance: Mapping[str, str], *, overwrite: bool = False
) -> None:
    """Write the statistics as FITS, with the metadata of the run that made them."""
    written = table.copy()
    written.meta.update(provenance)
    write_table(path, written, overwrite=overwrite)


def read_statistics(path: Path, shapes_path: Path, shapes: Table) -> Table:
    """Read the statistics that go with a table of ``shapes``, whose rows they share."""
    table = read_table(path, "file written by `uvshear measure --keep`")
    for name, read in ((path, table), (shapes_path, shapes)):
        if "id" not in read.colnames:
            raise InputError(f"{name}: has no column 'id'; a table as it was measured is needed")
    if len(table) != len(shapes):
        raise InputError(
            f"{path}: has {len(table)} rows, {shapes_path} {len(shapes)}; both are of one measurement"
        )
    if np.any(_identifiers(table) != _identifiers(shapes)):
        raise InputError(
            f"{path}: is of other sources than {shapes_path}; measure again, or sort neither"
        )
    # FITS has keys in capitals.
    table.meta = {str(name).lower(): value for name, value in table.meta.items()}
    return table


def _identifiers(table: Table) -> Array:
    return np.char.strip(table["id"].astype(str))
