"""Small MSv4 stores, made from Measurement Sets with plain xarray in the schema as xradio writes it."""

import warnings
from pathlib import Path

import numpy as np
import xarray as xr
import zarr
from casacore import tables

from uvshear.interferometer.stokes import CORRELATION_NAMES

MJD_OF_UNIX = 40587 * 86400.0
FIELDS = "field_and_source_base_xds"
ANTENNAS = "antenna_xds"

COLUMNS = (
    "ANTENNA1",
    "ANTENNA2",
    "DATA",
    "EXPOSURE",
    "FIELD_ID",
    "FLAG",
    "FLAG_ROW",
    "INTERVAL",
    "SCAN_NUMBER",
    "TIME",
    "UVW",
    "WEIGHT_SPECTRUM",
)

Tree = dict[str, xr.Dataset]
"""Groups of a store by their paths."""


def tree_of(ms: Path, name: str = "field") -> Tree:
    """Return the groups of a set: a partition for each DATA_DESC_ID, ``NAME_0`` ..., with its antennas and fields."""
    tree: Tree = {"": xr.Dataset(attrs={"type": "processing_set"})}
    with tables.table(str(ms), ack=False) as main:
        identifiers = main.getcol("DATA_DESC_ID")
        for number, identifier in enumerate(np.unique(identifiers)):
            rows = main.selectrows((identifiers == identifier).nonzero()[0])
            columns = {column: rows.getcol(column) for column in COLUMNS}
            tree[f"{name}_{number}"] = _partition(ms, columns, int(identifier))
            tree[f"{name}_{number}/{ANTENNAS}"] = _antennas(ms)
            tree[f"{name}_{number}/{FIELDS}"] = _fields(ms)
    return tree


def write_tree(
    tree: Tree, store: Path, *, zarr_format: int = 3, is_consolidated: bool = True
) -> Path:
    """Write groups as a store."""
    with warnings.catch_warnings():
        # Format 3 has no text of fixed length yet.
        warnings.simplefilter("ignore")
        for group, content in tree.items():
            content.to_zarr(
                store, group=group or None, mode="a", zarr_format=zarr_format, consolidated=False
            )
        if is_consolidated:
            zarr.consolidate_metadata(store, zarr_format=zarr_format)
    return store


def _partition(ms: Path, columns: dict[str, np.ndarray], identifier: int) -> xr.Dataset:
    """Put the rows of one DATA_DESC_ID on a grid of times and baselines, padded with NaN."""
    window, names = _setup(ms, identifier)
    time, step = np.unique(columns["TIME"], return_inverse=True)
    pairs = np.column_stack([columns["ANTENNA1"], columns["ANTENNA2"]])
    baselines, baseline = np.unique(pairs, axis=0, return_inverse=True)

    def gridded(values: np.ndarray, padding: object) -> np.ndarray:
        grid = np.full((len(time), len(baselines), *values.shape[1:]), padding, values.dtype)
        grid[step, baseline.ravel()] = values
        return grid

    def along_time(values: np.ndarray) -> np.ndarray:
        found = np.zeros(len(time), values.dtype)
        found[step] = values
        return found

    samples = ("time", "baseline_id", "frequency", "polarization")
    antennas, fields = _antenna_names(ms), _field_labels(ms)
    return xr.Dataset(
        {
            "VISIBILITY": (samples, gridded(columns["DATA"].astype("c8"), np.nan)),
            "WEIGHT": (samples, gridded(columns["WEIGHT_SPECTRUM"], np.nan)),
            # xradio does not flag what it pads.
            "FLAG": (samples, gridded(columns["FLAG"] | columns["FLAG_ROW"][:, None, None], False)),
            "UVW": (("time", "baseline_id", "uvw_label"), gridded(columns["UVW"], np.nan)),
            "EFFECTIVE_INTEGRATION_TIME": (
                ("time", "baseline_id"),
                gridded(columns["EXPOSURE"], np.nan),
                {"units": "s", "type": "quantity"},
            ),
        },
        coords={
            "time": (
                "time",
                time - MJD_OF_UNIX,
                {
                    "type": "time",
                    "units": "s",
                    "scale": "utc",
                    "format": "unix",
                    "integration_time": _quantity(float(np.median(columns["INTERVAL"])), "s"),
                },
            ),
            "field_name": ("time", fields[along_time(columns["FIELD_ID"])]),
            "scan_name": ("time", along_time(columns["SCAN_NUMBER"]).astype(str)),
            "baseline_id": np.arange(len(baselines)),
            "baseline_antenna1_name": ("baseline_id", antennas[baselines[:, 0]]),
            "baseline_antenna2_name": ("baseline_id", antennas[baselines[:, 1]]),
            "frequency": (
                "frequency",
                window["CHAN_FREQ"],
                {
                    "units": "Hz",
                    "observer": "TOPO",
                    "channel_width": _quantity(float(window["CHAN_WIDTH"][0]), "Hz"),
                },
            ),
            "polarization": names,
            "uvw_label": ["u", "v", "w"],
        },
        attrs={
            "schema_version": "4.0.1",
            "creator": {"software_name": "xradio", "version": "1.3.0"},
            "type": "visibility",
            "data_groups": {
                "base": {
                    "correlated_data": "VISIBILITY",
                    "flag": "FLAG",
                    "weight": "WEIGHT",
                    "uvw": "UVW",
                    "field_and_source": FIELDS,
                }
            },
            "processor_info": {
                "type": str(_column(ms, "PROCESSOR", "TYPE")[0]),
                "sub_type": str(_column(ms, "PROCESSOR", "SUB_TYPE")[0]),
            },
        },
    )


def _antennas(ms: Path) -> xr.Dataset:
    return xr.Dataset(
        {
            "ANTENNA_POSITION": (
                ("antenna_name", "cartesian_pos_label"),
                _column(ms, "ANTENNA", "POSITION"),
                {"units": "m", "frame": "ITRS"},
            ),
            "ANTENNA_DISH_DIAMETER": (
                "antenna_name",
                _column(ms, "ANTENNA", "DISH_DIAMETER"),
                {"units": "m"},
            ),
        },
        coords={
            "antenna_name": _antenna_names(ms),
            "cartesian_pos_label": ["x", "y", "z"],
        },
        attrs={
            "type": "antenna",
            "overall_telescope_name": str(_column(ms, "OBSERVATION", "TELESCOPE_NAME")[0]),
        },
    )


def _fields(ms: Path) -> xr.Dataset:
    return xr.Dataset(
        {
            "FIELD_PHASE_CENTER_DIRECTION": (
                ("field_name", "sky_dir_label"),
                _column(ms, "FIELD", "PHASE_DIR")[:, 0],
                {"type": "sky_coord", "units": "rad", "frame": "fk5"},
            )
        },
        coords={"field_name": _field_labels(ms), "sky_dir_label": ["ra", "dec"]},
        attrs={"type": "field_and_source"},
    )


def _antenna_names(ms: Path) -> np.ndarray:
    names = _column(ms, "ANTENNA", "NAME")
    return np.array([name or f"antenna {number}" for number, name in enumerate(names)])


def _field_labels(ms: Path) -> np.ndarray:
    """Return the names of fields as xradio makes them unique."""
    names = _column(ms, "FIELD", "NAME")
    return np.array([f"{name}_{number}" for number, name in enumerate(names)])


def _setup(ms: Path, identifier: int) -> tuple[dict[str, np.ndarray], list[str]]:
    window = int(_column(ms, "DATA_DESCRIPTION", "SPECTRAL_WINDOW_ID")[identifier])
    polarization = int(_column(ms, "DATA_DESCRIPTION", "POLARIZATION_ID")[identifier])
    with tables.table(f"{ms}::SPECTRAL_WINDOW", ack=False) as spectral:
        found = {name: spectral.getcell(name, window) for name in ("CHAN_FREQ", "CHAN_WIDTH")}
    with tables.table(f"{ms}::POLARIZATION", ack=False) as feeds:
        types = feeds.getcell("CORR_TYPE", polarization)
    return found, [CORRELATION_NAMES[int(code)] for code in types]


def _column(ms: Path, subtable: str, column: str) -> np.ndarray:
    with tables.table(f"{ms}::{subtable}", ack=False) as table:
        return np.asarray(table.getcol(column))


def _quantity(value: float, unit: str) -> dict[str, object]:
    return {"data": value, "dims": [], "attrs": {"units": unit, "type": "quantity"}}
