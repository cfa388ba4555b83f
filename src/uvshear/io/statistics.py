"""The file beside a table of shapes that holds the statistics for estimators of the shear."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from astropy.table import Column, Table

from uvshear.errors import InputError
from uvshear.io.tables import read_table, write_table
from uvshear.shapes.source_facet import Kept, Statistic
from uvshear.typing import Array


def statistics_path(shapes: Path) -> Path:
    """Return the name of the file of statistics that belongs to a table of shapes."""
    return shapes.with_name(f"{shapes.stem}.stats.fits")


def statistics_table(
    shapes: Table, estimators: Sequence[Statistic], kept: Mapping[int, Kept]
) -> Table:
    """Return the table of statistics, with a row for every row of the shapes.

    A source without statistics has NaN or an empty array.

    Parameters
    ----------
    shapes
        Table of shapes.
    estimators
        Estimators whose statistics were kept.
    kept
        Statistics of each source, by the number of its row.
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
    """Read the statistics that belong to a table of shapes, and check that both have the same sources."""
    table = read_table(path, "file written by `uvshear measure --keep`")
    for name, read in ((path, table), (shapes_path, shapes)):
        if "id" not in read.colnames:
            raise InputError(
                f"{name}: has no column 'id'; a table as `uvshear measure` wrote it is needed"
            )
    if len(table) != len(shapes):
        raise InputError(
            f"{path}: has {len(table)} rows, but {shapes_path} has {len(shapes)}; the files of one measurement have"
            " the same number of rows"
        )
    if np.any(_identifiers(table) != _identifiers(shapes)):
        raise InputError(
            f"{path}: has other sources than {shapes_path}, or has them in another order; measure again"
        )
    # FITS has keys in capitals.
    table.meta = {str(name).lower(): value for name, value in table.meta.items()}
    return table


def _identifiers(table: Table) -> Array:
    return np.char.strip(table["id"].astype(str))
