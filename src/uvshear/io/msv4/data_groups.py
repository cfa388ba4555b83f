"""Variables of an MSv4 partition that belong together: visibilities with their weights, flags, UVW and field."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from uvshear.errors import InputError
from uvshear.io.msv4.opening import Dataset

MSV2_COLUMNS: Final = {
    "DATA": ("base", "VISIBILITY"),
    "CORRECTED_DATA": ("corrected", "VISIBILITY_CORRECTED"),
    "MODEL_DATA": ("model", "VISIBILITY_MODEL"),
}
"""The data group and the variable that hold the column of a Measurement Set after its conversion by xradio."""

CORRELATED_DIMENSIONS: Final = ("time", "baseline_id", "frequency", "polarization")
"""Dimensions of visibilities in the order in which they are read."""


@dataclass(frozen=True)
class DataGroup:
    """Names of variables, and of the subgroup of fields.

    Parameters
    ----------
    visibilities
        Visibilities [Jy].
    weights
        1/sigma^2 [Jy^-2].
    flags
        Whether a sample is bad.
    uvw
        Baselines [m].
    field_and_source
        Subgroup of the fields.
    """

    visibilities: str
    weights: str
    flags: str
    uvw: str
    field_and_source: str


def choose_data_group(place: Path, partition: Dataset, column: str) -> DataGroup:
    """Return the variables that belong to some visibilities.

    Parameters
    ----------
    place
        Path of the partition.
    partition
        The partition.
    column
        A variable of visibilities, a data group, or the column of the Measurement Set from which they were converted
        (DATA, CORRECTED_DATA, MODEL_DATA).
    """
    groups = _data_groups(partition.attrs)
    name, visibilities = _meant(partition, groups, column)
    if visibilities not in partition.variables:
        like = ", ".join(visibility_variables(partition)) or "none"
        raise InputError(
            f"{place}: no variable {column}; the variables that hold visibilities are {like}"
        )
    check_visibilities(place, partition, visibilities)
    group = groups.get(name, {})
    # xarray-ms writes the path from the root of the store, xradio the name of the subgroup.
    field_and_source = str(group.get("field_and_source") or "field_and_source_base_xds")
    return DataGroup(
        visibilities,
        str(group.get("weight") or "WEIGHT"),
        str(group.get("flag") or "FLAG"),
        str(group.get("uvw") or "UVW"),
        field_and_source.rpartition("/")[2],
    )


def visibility_variables(partition: Dataset) -> tuple[str, ...]:
    """Names of the variables of complex numbers with the dimensions of visibilities."""
    return tuple(
        str(name)
        for name, variable in partition.data_vars.items()
        if variable.dtype.kind == "c" and set(variable.dims) == set(CORRELATED_DIMENSIONS)
    )


def check_visibilities(place: Path, partition: Dataset, name: str) -> None:
    """Refuse a variable that does not hold visibilities."""
    found = partition[name]
    if found.dtype.kind != "c":
        raise InputError(f"{place}: variable {name} holds {found.dtype}, not complex visibilities")
    if set(found.dims) != set(CORRELATED_DIMENSIONS):
        raise InputError(
            f"{place}: {name} has the dimensions ({', '.join(map(str, found.dims))});"
            f" ({', '.join(CORRELATED_DIMENSIONS)}) are needed"
        )


def _data_groups(attributes: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    groups = attributes.get("data_groups")
    if not isinstance(groups, dict):
        return {}
    return {str(name): group for name, group in groups.items() if isinstance(group, dict)}


def _meant(
    partition: Dataset, groups: Mapping[str, Mapping[str, Any]], column: str
) -> tuple[str, str]:
    """Return the data group and the variable that a name stands for."""
    name, variable = MSV2_COLUMNS.get(column, (column, column))
    if column in partition.variables:
        variable = column
    elif name in groups:
        variable = str(groups[name].get("correlated_data", variable))
    of_variable = [one for one, group in groups.items() if group.get("correlated_data") == variable]
    if name in groups and (name in of_variable or not of_variable):
        return name, variable
    return (of_variable or list(groups) or [name])[0], variable
