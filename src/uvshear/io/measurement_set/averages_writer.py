"""Write averages over cells of (u, v, w) as a Measurement Set that other programs can image.

Each row has one channel, in the spectral window of its sub-band, and one correlation, Stokes I. Baselines are in metres
at the frequency of the sub-band. Four columns are this package's own: the mean frequency and width of the samples of
each row, and two columns of moments. There are two antennas for each kind of dish, which stand for all of that kind.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import numpy as np
from casacore import tables

from uvshear.averaging.averager import Group
from uvshear.averaging.cell_table import Averages
from uvshear.averaging.cells import Cells
from uvshear.averaging.dish_pairs import DishPairs
from uvshear.averaging.sub_bands import RATIO, SubBand
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.stokes import STOKES_I
from uvshear.io.measurement_set.averaged_columns import (
    FOURTH,
    FREQUENCY,
    KEYWORD,
    SECOND,
    WIDTH,
)
from uvshear.io.measurement_set.subtables import TOPOCENTRIC, fill_subtable
from uvshear.io.measurement_set.writer import (
    SAME_SHAPE_COLUMNS,
    casacore_errors_of_output,
    check_measurement_set_output,
    tiled_manager,
)
from uvshear.io.measurement_set.writing import written
from uvshear.io.outputs import new_outputs

ROWS_AT_A_TIME: Final = 2**18

_TILED: Final[dict[str, tuple[Any, str, list[int], int]]] = {
    "DATA": (0j, "complex", [1, 1], 8),
    "FLAG": (False, "boolean", [1, 1], 1),
    "WEIGHT": (0.0, "float", [1], 4),
    "SIGMA": (0.0, "float", [1], 4),
    "UVW": (0.0, "double", [3], 8),
    SECOND: (0.0, "float", [6], 4),
    FOURTH: (0.0, "float", [15], 4),
}
"""For each tiled column: an example of a number, its type, the shape of the column's values, and bytes per number."""

_ROW_COLUMNS: Final = ("TIME", "TIME_CENTROID", "EXPOSURE", "INTERVAL", FREQUENCY, WIDTH)
_REPEATED: Final = ("ANTENNA1", "ANTENNA2", "DATA_DESC_ID")
_CONSTANT: Final = (
    "ARRAY_ID",
    "FEED1",
    "FEED2",
    "FIELD_ID",
    "FLAG_CATEGORY",
    "FLAG_ROW",
    "OBSERVATION_ID",
    "PROCESSOR_ID",
    "SCAN_NUMBER",
    "STATE_ID",
)


@dataclass(frozen=True)
class AveragedField:
    """What the averages of a field have in common.

    Parameters
    ----------
    phase_centre
        Direction of l = m = 0.
    pointing
        Direction in which the dishes pointed.
    pairs
        Kinds of dishes.
    cells
        Sizes of the cells.
    """

    phase_centre: PhaseCentre
    pointing: PhaseCentre
    pairs: DishPairs
    cells: Cells


@dataclass
class AveragesWriter:
    """An unfinished Measurement Set to which averages are added."""

    path: Path
    about: AveragedField
    _bands: list[SubBand] = field(default_factory=list)
    _time: list[float] = field(default_factory=list)
    rows: int = 0

    def add(self, group: Group, averages: Averages) -> None:
        """Add averages of a sub-band and of a kind of dish pair."""
        if group.band not in self._bands:
            self._bands.append(group.band)
        first, second = self.about.pairs.kinds(group.pair)
        self._time += [
            float((averages.time - averages.interval / 2).min()),
            float((averages.time + averages.interval / 2).max()),
        ]
        with written(tables.table(str(self.path), readonly=False, ack=False)) as main:
            for start in range(0, len(averages), ROWS_AT_A_TIME):
                rows = slice(start, start + ROWS_AT_A_TIME)
                count = len(averages.weights[rows])
                main.addrows(count)
                constants = {
                    "ANTENNA1": 2 * first,
                    "ANTENNA2": 2 * second + 1,
                    "DATA_DESC_ID": self._bands.index(group.band),
                }
                for name, value in constants.items():
                    main.putcol(name, np.full(count, value, np.int32), self.rows, count)
                for name, values in _columns(averages, rows).items():
                    main.putcol(name, values, self.rows, count)
                self.rows += count

    def finish(self, history: str) -> None:
        """Write the subtables, once all averages have been added."""
        contents = _subtables(self.about, self._bands, (min(self._time), max(self._time)), history)
        for name, columns in contents.items():
            fill_subtable(self.path / name, columns)


@contextmanager
def new_averages(
    target: Path, about: AveragedField, *, overwrite: bool = False
) -> Iterator[AveragesWriter]:
    """Yield a writer of a Measurement Set, which gets its final name at the end of the block if no error occurred."""
    check_measurement_set_output(target, overwrite=overwrite)
    with casacore_errors_of_output(target), new_outputs(target) as outputs:
        unfinished = outputs.new(target, overwrite=overwrite)
        _create(unfinished, about)
        yield AveragesWriter(unfinished, about)


def _columns(averages: Averages, rows: slice) -> dict[str, object]:
    weights = averages.weights[rows]
    return {
        "TIME": averages.time[rows],
        "TIME_CENTROID": averages.time[rows],
        "EXPOSURE": averages.interval[rows],
        "INTERVAL": averages.interval[rows],
        FREQUENCY: averages.rows.frequency[rows],
        WIDTH: averages.rows.width[rows],
        SECOND: averages.rows.second[rows].astype(np.float32),
        FOURTH: averages.rows.fourth[rows].astype(np.float32),
        "UVW": averages.uvw[rows],
        "DATA": averages.stokes_i[rows][:, None, None],
        "FLAG": np.zeros((len(weights), 1, 1), bool),
        "WEIGHT": weights[:, None].astype(np.float32),
        "SIGMA": (1 / np.sqrt(weights))[:, None].astype(np.float32),
    }


def _create(path: Path, about: AveragedField) -> None:
    """Create a Measurement Set without rows."""
    description, managers = tables.required_ms_desc("MAIN"), {}
    for name, (example, kind, shape, item_bytes) in _TILED.items():
        managers[f"Tiled{name}"] = tiled_manager(name, shape, item_bytes, ROWS_AT_A_TIME)
        if name not in description:
            description |= tables.maketabdesc(
                tables.makearrcoldesc(name, example, ndim=len(shape), valuetype=kind)
            )
        if name in SAME_SHAPE_COLUMNS or name in {SECOND, FOURTH}:
            description[name] |= {"option": 5, "shape": shape, "ndim": len(shape)}
        else:
            description[name] |= {"option": 4, "shape": shape, "ndim": len(shape)}
    for name in (FREQUENCY, WIDTH):
        description |= tables.maketabdesc(tables.makescacoldesc(name, 0.0, valuetype="double"))
    for name in (*_REPEATED, *_CONSTANT):
        managers[name] = {"TYPE": "IncrementalStMan", "NAME": name, "COLUMNS": [name]}
    managers["Rows"] = {
        "TYPE": "StandardStMan",
        "NAME": "Rows",
        "COLUMNS": list(_ROW_COLUMNS),
        "SPEC": {"BUCKETSIZE": 2**17},
    }
    for name, manager in managers.items():
        for column in manager["COLUMNS"]:
            description[column] |= {
                "dataManagerType": manager["TYPE"],
                "dataManagerGroup": name,
            }
    description["UVW"]["keywords"]["MEASINFO"]["Ref"] = "J2000"
    with written(tables.default_ms(str(path), description, managers)) as main:
        main.putkeyword(KEYWORD, {"UV": about.cells.uv, "W": about.cells.w})


def _subtables(
    about: AveragedField, bands: Sequence[SubBand], time: tuple[float, float], history: str
) -> dict[str, Mapping[str, object]]:
    diameters = np.repeat(about.pairs.diameters, 2)
    count, middle, length = len(diameters), sum(time) / 2, time[1] - time[0]
    names = [f"{diameter:g}m-{end}" for diameter in about.pairs.diameters for end in (1, 2)]
    centre, pointing = (
        np.array([[[one.ra, one.dec]]]) for one in (about.phase_centre, about.pointing)
    )
    frequency = np.array([[band.frequency] for band in bands])
    width = frequency * (RATIO**0.5 - RATIO**-0.5)
    false = np.zeros(len(bands), bool)
    return {
        "ANTENNA": {
            "NAME": names,
            "STATION": names,
            "TYPE": ["GROUND-BASED"] * count,
            "MOUNT": ["ALT-AZ"] * count,
            "POSITION": np.zeros((count, 3)),
            "OFFSET": np.zeros((count, 3)),
            "DISH_DIAMETER": diameters,
            "FLAG_ROW": np.zeros(count, bool),
        },
        "FEED": {
            "ANTENNA_ID": np.arange(count, dtype=np.int32),
            "FEED_ID": np.zeros(count, np.int32),
            "SPECTRAL_WINDOW_ID": np.full(count, -1, np.int32),
            "TIME": np.full(count, middle),
            "INTERVAL": np.full(count, length),
            "NUM_RECEPTORS": np.full(count, 2, np.int32),
            "BEAM_ID": np.full(count, -1, np.int32),
            "BEAM_OFFSET": np.zeros((count, 2, 2)),
            "POLARIZATION_TYPE": {"array": ["X", "Y"] * count, "shape": [count, 2]},
            "POL_RESPONSE": np.tile(np.eye(2, dtype=np.complex64), (count, 1, 1)),
            "POSITION": np.zeros((count, 3)),
            "RECEPTOR_ANGLE": np.zeros((count, 2)),
        },
        "FIELD": {
            "NAME": ["averaged"],
            "CODE": [""],
            "TIME": [time[0]],
            "NUM_POLY": [0],
            "DELAY_DIR": pointing,
            "PHASE_DIR": centre,
            "REFERENCE_DIR": pointing,
            "SOURCE_ID": [-1],
            "FLAG_ROW": [False],
        },
        "SPECTRAL_WINDOW": {
            "NAME": [f"sub-band {band.frequency / 1e6:.0f} MHz" for band in bands],
            "NUM_CHAN": np.ones(len(bands), np.int32),
            "CHAN_FREQ": frequency,
            "CHAN_WIDTH": width,
            "EFFECTIVE_BW": width,
            "RESOLUTION": width,
            "REF_FREQUENCY": frequency[:, 0],
            "TOTAL_BANDWIDTH": width[:, 0],
            "MEAS_FREQ_REF": np.full(len(bands), TOPOCENTRIC, np.int32),
            "NET_SIDEBAND": np.ones(len(bands), np.int32),
            "FREQ_GROUP": np.zeros(len(bands), np.int32),
            "FREQ_GROUP_NAME": [""] * len(bands),
            "IF_CONV_CHAIN": np.zeros(len(bands), np.int32),
            "FLAG_ROW": false,
        },
        "POLARIZATION": {
            "NUM_CORR": [1],
            "CORR_TYPE": np.array([[STOKES_I]], np.int32),
            "CORR_PRODUCT": np.array([[[0, 0]]], np.int32),
            "FLAG_ROW": [False],
        },
        "DATA_DESCRIPTION": {
            "SPECTRAL_WINDOW_ID": np.arange(len(bands), dtype=np.int32),
            "POLARIZATION_ID": np.zeros(len(bands), np.int32),
            "FLAG_ROW": false,
        },
        "OBSERVATION": {
            "TELESCOPE_NAME": ["averaged"],
            "TIME_RANGE": np.array([time]),
            "OBSERVER": [""],
            "LOG": {"array": [""], "shape": [1, 1]},
            "SCHEDULE_TYPE": [""],
            "SCHEDULE": {"array": [""], "shape": [1, 1]},
            "PROJECT": [""],
            "RELEASE_DATE": [time[1]],
            "FLAG_ROW": [False],
        },
        "STATE": {
            "SIG": [True],
            "REF": [False],
            "CAL": [0.0],
            "LOAD": [0.0],
            "SUB_SCAN": [0],
            "OBS_MODE": ["OBSERVE_TARGET.ON_SOURCE"],
            "FLAG_ROW": [False],
        },
        "PROCESSOR": {
            "TYPE": ["CORRELATOR"],
            "SUB_TYPE": [""],
            "TYPE_ID": [0],
            "MODE_ID": [0],
            "FLAG_ROW": [False],
        },
        "HISTORY": {
            "TIME": [time[1]],
            "OBSERVATION_ID": [0],
            "MESSAGE": [history],
            "PRIORITY": ["NORMAL"],
            "ORIGIN": ["uvshear average"],
            "OBJECT_ID": [0],
            "APPLICATION": [f"uvshear {version('uvshear')}"],
            "CLI_COMMAND": {"array": [""], "shape": [1, 1]},
            "APP_PARAMS": {"array": [""], "shape": [1, 1]},
        },
    }
