"""The file beside a table of shapes that holds the statistics for estimators of the shear."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from astropy.table import Column, Table

from uvshear.errors import InputError
from uvshear.io.row_checksums import CHECKSUM, changed_rows, checksums
from uvshear.io.run_identity import companion, run_of
from uvshear.io.shape_checks import as_words
from uvshear.io.tables import read_table, write_table
from uvshear.shapes.source_facet import Kept, Statistic
from uvshear.shapes.statistic_flag import StatisticFlag, flag_column
from uvshear.typing import Array, Int


def statistics_path(shapes: Path) -> Path:
    """Return the name of the file of statistics that belongs to a table of shapes."""
    return companion(shapes, "stats")


def statistics_table(
    shapes: Table, estimators: Sequence[Statistic], kept: Mapping[int, Kept]
) -> Table:
    """Return the table of statistics, with a row for every row of the shapes.

    A source without statistics has NaN or an empty array, and a flag for each estimator that tells the reason.

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
        if name := getattr(estimator, "name", ""):
            table[flag_column(name)] = _flags(estimator, flag_column(name), len(shapes), kept)
        for name, column in estimator.columns.items():
            values = _values(name, len(shapes), kept)
            table[name] = Column(values, unit=column.unit, description=column.description)
    return table


def missing_statistics(table: Table, estimator: str) -> Mapping[str, int]:
    """Count the measured sources without a statistic by their flag, the most frequent first.

    Parameters
    ----------
    table
        Table of statistics.
    estimator
        Name of the estimator.
    """
    name = flag_column(estimator)
    # Files of earlier versions have no flags.
    flags = Counter(map(str, table[name]) if name in table.colnames else ())
    told = {StatisticFlag.OK.word, StatisticFlag.NOT_MEASURED.word}
    return {flag: count for flag, count in flags.most_common() if flag not in told}


def _flags(estimator: Statistic, name: str, rows: int, kept: Mapping[int, Kept]) -> Column:
    """Return the flags of an estimator; an extraction that tells none has OK where there are numbers."""
    flags = [StatisticFlag.NOT_MEASURED.word] * rows
    for source, numbers in kept.items():
        has_numbers = any(column in numbers for column in estimator.columns)
        known = StatisticFlag.OK if has_numbers else StatisticFlag.NOT_FITTED
        flags[source] = str(numbers.get(name, known.word))
    return Column(flags, description="ok, or the reason why the source has no such statistic")


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
    written = table[[name for name in table.colnames if name != CHECKSUM]]
    written.meta.update(provenance)
    written[CHECKSUM] = checksums(written)
    write_table(path, written, overwrite=overwrite)


def read_statistics(path: Path, shapes_path: Path, shapes: Table) -> Table:
    """Read the statistics that belong to a table of shapes.

    Raises
    ------
    InputError
        The file belongs to another measurement, has not all sources of the shapes, or was changed after the writing.
    """
    table = read_table(path, "file written by `uvshear measure --keep`")
    for name, read in ((path, table), (shapes_path, shapes)):
        if "id" not in read.colnames:
            raise InputError(
                f"{name}: has no column 'id'; a table as `uvshear measure` wrote it is needed"
            )
    runs = run_of(table), run_of(shapes)
    if runs[0] != runs[1]:
        raise InputError(
            f"{path}: belongs to another measurement than {shapes_path} (their entries RUN are {runs[0]} and"
            f" {runs[1]}); measure again"
        )
    known, wanted = _identifiers(table, path), _identifiers(shapes, shapes_path)
    if (changed := changed_rows(table)).any():
        raise InputError(
            f"{path}: the numbers of {np.count_nonzero(changed)} of {len(table)} sources (the first is"
            f" {known[changed][0]}) are not those that were written, by their checksums; measure again"
        )
    table = table[_rows(known, wanted, path, shapes_path)]
    if CHECKSUM in table.colnames:
        table.remove_column(CHECKSUM)
    # FITS has keys in capitals.
    table.meta = {str(name).lower(): value for name, value in table.meta.items()}
    return table


def _rows(known: Array, wanted: Array, path: Path, shapes_path: Path) -> Int[Array, " source"]:
    """Return the row of each wanted source; shapes may have been selected and sorted."""
    if len(np.unique(known)) < len(known) or len(np.unique(wanted)) < len(wanted):
        if np.array_equal(known, wanted):
            return np.arange(len(known))
        raise InputError(f"{path}: has sources of the same id, so that they cannot be told apart")
    order = np.argsort(known)
    place = np.minimum(np.searchsorted(known, wanted, sorter=order), len(known) - 1)
    rows: Int[Array, " source"] = order[place]
    if len(missing := wanted[known[rows] != wanted]):
        raise InputError(
            f"{path}: has no source {missing[0]}, which {shapes_path} has; measure again"
        )
    return rows


def _identifiers(table: Table, name: Path) -> Array:
    """Return identifiers as text: FITS fills text with blanks, and numbers may be text in another format."""
    column = table["id"]
    if column.dtype.kind in "SUO":
        return as_words(column, f"{name}: column 'id'")
    if column.ndim != 1:
        raise InputError(f"{name}: column 'id' holds arrays; one identifier for each row is needed")
    return np.ma.filled(np.ma.asarray(column).astype(str), "")
