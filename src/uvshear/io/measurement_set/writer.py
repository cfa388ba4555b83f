"""Write a simulated observation as a Measurement Set that wsclean, CASA and casacore open."""

import math
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import numpy as np
from casacore import tables

from uvshear.errors import InputError
from uvshear.execution import SERIAL, Executor
from uvshear.interferometer.coverage import Coverage
from uvshear.interferometer.stokes import Hands
from uvshear.io.disk_space import require_space
from uvshear.io.measurement_set.subtables import write_subtables
from uvshear.io.measurement_set.writing import written
from uvshear.io.outputs import check_output, new_outputs
from uvshear.progress import Meter, Progress, Stage
from uvshear.simulation.in_stages import blocks_in_stages
from uvshear.simulation.observation import CorrelationBlock, SimulatedObservation

TILE_BYTES: Final = 2**20
"""Size of a tile of each column, which is the least that a reader reads."""

DESCRIPTION: Final = "table.dat"
"""File with the description of a table: its columns, where their values are stored, its keywords and its rows."""

OTHER_BYTES: Final = 40
"""Bytes of a row in columns that are not tiled (24), and its share of the subtables."""

SMALL_BYTES: Final = 2e6
"""Bytes of small files (0.8 MB for the 197 antennas of SKA-Mid)."""

CONSTANT_COLUMNS: Final = (
    "ARRAY_ID",
    "DATA_DESC_ID",
    "FEED1",
    "FEED2",
    "FIELD_ID",
    "FLAG_ROW",
    "OBSERVATION_ID",
    "PROCESSOR_ID",
    "SCAN_NUMBER",
    "STATE_ID",
    "EXPOSURE",
    "INTERVAL",
)
"""Columns with the same value in all rows, stored once."""

REPEATED_COLUMNS: Final = ("TIME", "TIME_CENTROID", "ANTENNA1")
"""Columns with the same value in many rows one after the other, stored once for all of them."""

ROW_COLUMNS: Final = ("ANTENNA2", "FLAG_CATEGORY")
"""Columns that have a value of their own in each row, or a place for one."""

BUCKET_BYTES: Final = 2**17
"""Size of a bucket of these columns. With casacore's usual buckets of 32 rows, ANTENNA2 takes six times as long to
write, and eight times as long to read."""

SAME_SHAPE_COLUMNS: Final = ("UVW", "WEIGHT", "SIGMA")
"""Tiled columns whose description fixes the shape of the cells.

The shape of the others depends on the number of channels, and is left open: where it was fixed, CASA's concat appended
a set with another number of channels without its visibilities, and without a warning.
"""


def write_measurement_set(
    path: str | Path,
    observation: SimulatedObservation,
    *,
    overwrite: bool = False,
    executor: Executor = SERIAL,
    hands: Hands = Hands.LINEAR,
    progress: Progress | None = None,
) -> None:
    """Simulate an observation and write it, a block of rows at a time; completely or not at all.

    Parameters
    ----------
    path
        Path of the Measurement Set, which is written under a temporary name beside it, then renamed.
    observation
        Observation to simulate.
    overwrite
        Whether a Measurement Set that exists is replaced.
    executor
        Executor of the prediction, and of the blocks with their noise.
    hands
        Kind of feed.
    progress
        Function that is called with the work done and the total work expected, in nanoseconds of one core, or an
        observer of the stages.
    """
    target = Path(path)
    check_measurement_set_output(target, overwrite=overwrite)
    require_space(target, _size(observation))
    meter = Meter(progress)
    meter.begin(Stage("preparation"))
    with casacore_errors_of_output(target), new_outputs(target) as outputs:
        unfinished = outputs.new(target, overwrite=overwrite)
        description = _create_twice(unfinished, observation)
        write_subtables(unfinished, observation, hands)
        with written(tables.table(str(unfinished), readonly=False, ack=False)) as main:
            for block in blocks_in_stages(observation, executor, meter):
                _write_block(main, observation.coverage, block)
        (unfinished / DESCRIPTION).write_bytes(description)
        meter.finish()


def _size(observation: SimulatedObservation) -> float:
    """Return the size of a set [bytes], which is not exceeded."""
    rows, size = len(observation.coverage), SMALL_BYTES
    for _, _, shape, item_bytes in _tiled(observation).values():
        tile_rows = _tile_rows(shape, item_bytes, rows)
        size += math.prod(shape) * item_bytes * tile_rows * math.ceil(rows / tile_rows)
    return size + OTHER_BYTES * rows


def check_measurement_set_output(target: Path, *, overwrite: bool) -> None:
    """Refuse a target that cannot be written as a Measurement Set, before anything is computed for it."""
    check_output(target, overwrite=overwrite)
    if target.exists() and not (target / "table.dat").is_file():
        raise InputError(
            f"{target}: is not a Measurement Set, and will not be overwritten; choose another name"
        )


@contextmanager
def casacore_errors_of_output(target: Path) -> Iterator[None]:
    """Turn casacore's errors while a set is written into one line."""
    try:
        yield
    except (RuntimeError, OSError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{target}: cannot be written ({reason})") from error


def _tiled(observation: SimulatedObservation) -> dict[str, tuple[Any, str, list[int], int]]:
    """Return an example, the type, the shape and the bytes of a number of the cells of each tiled column."""
    chan, corr = len(observation.channels), 2
    return {
        "DATA": (0j, "complex", [chan, corr], 8),
        "FLAG": (False, "boolean", [chan, corr], 1),
        "WEIGHT_SPECTRUM": (0.0, "float", [chan, corr], 4),
        "SIGMA_SPECTRUM": (0.0, "float", [chan, corr], 4),
        "WEIGHT": (0.0, "float", [corr], 4),
        "SIGMA": (0.0, "float", [corr], 4),
        "UVW": (0.0, "double", [3], 8),
    }


def _create_twice(path: Path, observation: SimulatedObservation) -> bytes:
    """Create a Measurement Set of one row whose shapes are all fixed, and return the description of the whole set.

    In that description shapes are open. casacore takes 0.3 us for each cell of open shape that is written, and hardly
    anything for one of fixed shape. The cells are stored in the same way, byte for byte: the sets differ in their
    descriptions alone.
    """
    _create(path, observation, SAME_SHAPE_COLUMNS, len(observation.coverage))
    description = (path / DESCRIPTION).read_bytes()
    shutil.rmtree(path)
    _create(path, observation, tuple(_tiled(observation)), 1)
    return description


def _create(path: Path, observation: SimulatedObservation, fixed: Sequence[str], rows: int) -> None:
    """Create a Measurement Set of this number of rows, with tiled columns that are not filled yet.

    The description fixes the shape of the cells of the columns in ``fixed``.
    """
    tiled = _tiled(observation)
    description, managers = tables.required_ms_desc("MAIN"), {}
    for name, (example, kind, shape, item_bytes) in tiled.items():
        managers[f"Tiled{name}"] = tiled_manager(name, shape, item_bytes, len(observation.coverage))
        if name not in description:
            column = tables.makearrcoldesc(
                name, example, ndim=len(shape), valuetype=kind, comment="One value a sample"
            )
            description |= tables.maketabdesc(column)
        if name in SAME_SHAPE_COLUMNS:
            description[name] |= {"option": 5, "shape": shape, "ndim": len(shape)}
        elif name in fixed:
            description[name] |= {"option": 4, "shape": shape, "ndim": len(shape)}
    once = {"Constant": CONSTANT_COLUMNS} | {name: (name,) for name in REPEATED_COLUMNS}
    for name, columns in once.items():
        managers[name] = {"TYPE": "IncrementalStMan", "NAME": name, "COLUMNS": list(columns)}
    managers["Rows"] = {
        "TYPE": "StandardStMan",
        "NAME": "Rows",
        "COLUMNS": list(ROW_COLUMNS),
        "SPEC": {"BUCKETSIZE": BUCKET_BYTES},
    }
    for name, manager in managers.items():
        for column in manager["COLUMNS"]:
            description[column] |= {
                "dataManagerType": manager["TYPE"],
                "dataManagerGroup": name,
            }
    description["UVW"]["keywords"]["MEASINFO"]["Ref"] = "J2000"
    with written(tables.default_ms(str(path), description, managers)) as main:
        # Rows that are added to an incremental column take over its last value.
        main.addrows(1)
        _write_constants(main, observation)
        main.addrows(rows - 1)


def tiled_manager(column: str, shape: list[int], item_bytes: int, rows: int) -> dict[str, Any]:
    """Describe the storage of a tiled column of this number of rows."""
    tile_rows = _tile_rows(shape, item_bytes, rows)
    return {
        "TYPE": "TiledColumnStMan" if column in SAME_SHAPE_COLUMNS else "TiledShapeStMan",
        "NAME": f"Tiled{column}",
        "COLUMNS": [column],
        "SPEC": {"DEFAULTTILESHAPE": np.array([*reversed(shape), tile_rows], dtype=np.int32)},
    }


def _tile_rows(shape: list[int], item_bytes: int, rows: int) -> int:
    return max(1, min(rows, TILE_BYTES // (math.prod(shape) * item_bytes)))


def _write_constants(main: tables.table, observation: SimulatedObservation) -> None:
    """Fill the first row of the constant columns; EXPOSURE is 0 for samples that are no averages."""
    coverage = observation.coverage
    for column in CONSTANT_COLUMNS:
        value: object = 0
        if column == "FLAG_ROW":
            value = False
        elif column == "SCAN_NUMBER":
            value = 1
        elif column == "INTERVAL":
            value = coverage.integration
        elif column == "EXPOSURE":
            value = coverage.integration if observation.is_averaged else 0.0
        main.putcell(column, 0, value)


def _write_block(main: tables.table, coverage: Coverage, block: CorrelationBlock) -> None:
    start, count = block.first_row, len(block)
    # A row that is added just before it is filled is written once, and not twice.
    main.addrows(start + count - main.nrows())
    rows = coverage.rows(slice(start, start + count))
    weight_spectrum = 1 / block.sigma**2
    weight = weight_spectrum.mean(axis=1)
    columns = {
        "TIME": rows.time,
        "TIME_CENTROID": rows.time,
        "ANTENNA1": rows.antenna1,
        "ANTENNA2": rows.antenna2,
        "UVW": rows.uvw,
        "DATA": block.correlations,
        "FLAG": np.zeros(block.correlations.shape, dtype=bool),
        "WEIGHT_SPECTRUM": weight_spectrum,
        "SIGMA_SPECTRUM": block.sigma,
        "WEIGHT": weight,
        "SIGMA": 1 / np.sqrt(weight),
    }
    for name, values in columns.items():
        main.putcol(name, values, start, count)
