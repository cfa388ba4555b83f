"""The file beside a table of shapes that holds what estimators of the shear need of every source."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from astropy.table import Column, Table

from uvshear.errors import InputError
from uvshear.io.tables import read_table, write_table
from uvshear.typing import Array

_DESCRIPTIONS = {
    "m1": ("moment of u^2 - v^2, weight exp(-k^2/2s^2), s = 15000 wavelengths", "Jy"),
    "m2": ("moment of 2uv", "Jy"),
    "m_size": ("moment of u^2 + v^2", "Jy"),
    "r11": ("derivative of m1 by g1", "Jy"),
    "r12": ("derivative of m1 by g2, and of m2 by g1", "Jy"),
    "r22": ("derivative of m2 by g2", "Jy"),
    "r_third": ("third order of m1 and m2 in the shear", "Jy"),
    "m1_var": ("variance of m1 by noise", "Jy2"),
    "m2_var": ("variance of m2 by noise", "Jy2"),
    "m12_cov": ("covariance of m1 and m2 by noise", "Jy2"),
    "mc1": ("weighted e1 behind a round beam", None),
    "mc2": ("weighted e2 behind a round beam", None),
    "mc_r11": ("derivative of mc1 by g1", None),
    "mc_r12": ("derivative of mc1 by g2", None),
    "mc_r21": ("derivative of mc2 by g1", None),
    "mc_r22": ("derivative of mc2 by g2", None),
    "lattice": (
        "origin of the lattice in (e1, e2, ln(scale length/rad)), and its axes by rows",
        None,
    ),
    "columns": ("of the lattice: three coordinates of its lowest node, and nodes, each", None),
    "log_likelihood": ("below the highest, column by column, in thousandths", None),
    "flux_terms": ("polynomial of the flux at each node", "Jy"),
    "variance_terms": ("polynomial of the logarithm of its variance / Jy2", None),
}


def statistics_path(shapes: Path) -> Path:
    """Name of the file that goes with a table of shapes."""
    return shapes.with_name(f"{shapes.stem}.stats.fits")


def statistics_table(
    identifier: Array, columns: tuple[str, ...], kept: Mapping[int, Mapping[str, float | Array]]
) -> Table:
    """One row a source of the catalogue; NaN, or an empty array, where nothing was kept."""
    table = Table({"id": identifier})
    for name in columns:
        known = {source: numbers[name] for source, numbers in kept.items() if name in numbers}
        values: Array = np.full(len(identifier), np.nan)
        arrays = [value for value in known.values() if isinstance(value, np.ndarray)]
        if arrays:
            values = np.empty(len(identifier), object)
            values[:] = [arrays[0][:0]] * len(identifier)
        for source, value in known.items():
            values[source] = value
        description, unit = _DESCRIPTIONS[name]
        table[name] = Column(values, unit=unit, description=description)
    return table


def keep_statistics(
    shapes: Path,
    identifier: Array,
    columns: tuple[str, ...],
    kept: Mapping[int, Mapping[str, float | Array]],
    *,
    overwrite: bool,
) -> None:
    """Write what was kept beside the shapes; without columns, remove what is there of an overwritten measurement."""
    path = statistics_path(shapes)
    if columns:
        table = statistics_table(identifier, columns, kept)
        write_statistics(path, table, overwrite=overwrite)
    elif overwrite:
        path.unlink(missing_ok=True)


def write_statistics(path: Path, table: Table, *, overwrite: bool = False) -> None:
    """Write them as FITS."""
    write_table(path, table, overwrite=overwrite)


def read_statistics(path: Path, shapes: Table, columns: tuple[str, ...], keep: str) -> Table:
    """Read what goes with a table of ``shapes``, of this path; ``keep`` is the option that makes the columns."""
    beside = statistics_path(path)
    if not beside.exists():
        raise InputError(
            f"{beside}: no such file, which this estimator needs; measure again with --keep {keep}"
        )
    table = read_table(beside, f"file written by `uvshear measure --keep {keep}`")
    if lacking := [name for name in columns if name not in table.colnames]:
        raise InputError(
            f"{beside}: has no column '{lacking[0]}'; measure again with --keep {keep}"
        )
    for name, one in ((beside, table), (path, shapes)):
        if "id" not in one.colnames:
            raise InputError(f"{name}: has no column 'id'; a table as it was measured is needed")
    if len(table) != len(shapes):
        raise InputError(
            f"{beside}: has {len(table)} rows, {path} {len(shapes)}; both are of one measurement"
        )
    if np.any(_identifiers(table) != _identifiers(shapes)):
        raise InputError(
            f"{beside}: is of other sources than {path}; measure again, or sort neither"
        )
    return table


def _identifiers(table: Table) -> Array:
    return np.char.strip(table["id"].astype(str))
