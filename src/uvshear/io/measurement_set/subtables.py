"""Subtables of the Measurement Set of a simulated observation."""

import shutil
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path

import numpy as np
from casacore import tables

from uvshear.interferometer.stokes import Hands
from uvshear.io.measurement_set.writing import written
from uvshear.simulation.observation import SimulatedObservation

TOPOCENTRIC = 5
"""Code of the observer's own frame in MEAS_FREQ_REF (casacore, MFrequency::Types)."""


def write_subtables(path: Path, observation: SimulatedObservation, hands: Hands) -> None:
    """Fill all subtables; FLAG_CMD has no rows, as nothing is flagged."""
    contents = {
        "ANTENNA": _antenna(observation),
        "FEED": _feed(observation, hands),
        "FIELD": _field(observation),
        "SPECTRAL_WINDOW": _spectral_window(observation),
        "POLARIZATION": _polarization(hands),
        "DATA_DESCRIPTION": {
            "SPECTRAL_WINDOW_ID": [0],
            "POLARIZATION_ID": [0],
            "FLAG_ROW": [False],
        },
        "OBSERVATION": _observation(observation),
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
            "SUB_TYPE": ["SIMULATOR"],
            "TYPE_ID": [0],
            "MODE_ID": [0],
            "FLAG_ROW": [False],
        },
        "POINTING": _pointing(observation),
        "HISTORY": _history(observation),
    }
    for name, columns in contents.items():
        fill_subtable(path / name, columns)


def fill_subtable(path: Path, columns: Mapping[str, object]) -> None:
    """Replace an empty table by one that has its rows from the start.

    Only then table.dat has their number. If rows are added later, only the file of the table's lock, table.lock, has
    it, which is lost easily: it is no data, and not all programs copy it.
    """
    rows = len(columns[next(iter(columns))])  # type: ignore[arg-type]
    with tables.table(str(path), ack=False) as empty:
        description = empty.getdesc()
    shutil.rmtree(path)
    with written(tables.table(str(path), description, nrow=rows, ack=False)) as subtable:
        for name, values in columns.items():
            subtable.putcol(name, values)


def _time_range(observation: SimulatedObservation) -> tuple[float, float]:
    half = observation.coverage.integration / 2
    time = observation.coverage.time
    return float(time.min()) - half, float(time.max()) + half


def _direction(observation: SimulatedObservation) -> tuple[float, float]:
    return observation.phase_centre.ra, observation.phase_centre.dec


def _antenna(observation: SimulatedObservation) -> dict[str, object]:
    layout = observation.coverage.layout
    count = len(layout)
    return {
        "NAME": list(layout.antenna_names),
        "STATION": list(layout.antenna_names),
        "TYPE": ["GROUND-BASED"] * count,
        "MOUNT": ["ALT-AZ"] * count,
        "POSITION": layout.positions,
        "OFFSET": np.zeros((count, 3)),
        "DISH_DIAMETER": np.nan_to_num(layout.diameters, nan=0.0),
        "FLAG_ROW": np.zeros(count, dtype=bool),
    }


def _feed(observation: SimulatedObservation, hands: Hands) -> dict[str, object]:
    count = len(observation.coverage.layout)
    start, stop = _time_range(observation)
    return {
        "ANTENNA_ID": np.arange(count, dtype=np.int32),
        "FEED_ID": np.zeros(count, dtype=np.int32),
        "SPECTRAL_WINDOW_ID": np.full(count, -1, dtype=np.int32),
        "TIME": np.full(count, (start + stop) / 2),
        "INTERVAL": np.full(count, stop - start),
        "NUM_RECEPTORS": np.full(count, 2, dtype=np.int32),
        "BEAM_ID": np.full(count, -1, dtype=np.int32),
        "BEAM_OFFSET": np.zeros((count, 2, 2)),
        "POLARIZATION_TYPE": {"array": list(hands.receptors) * count, "shape": [count, 2]},
        "POL_RESPONSE": np.tile(np.eye(2, dtype=np.complex64), (count, 1, 1)),
        "POSITION": np.zeros((count, 3)),
        "RECEPTOR_ANGLE": np.zeros((count, 2)),
    }


def _field(observation: SimulatedObservation) -> dict[str, object]:
    direction = np.array(_direction(observation)).reshape(1, 1, 2)
    return {
        "NAME": ["simulated"],
        "CODE": [""],
        "TIME": [_time_range(observation)[0]],
        "NUM_POLY": [0],
        "DELAY_DIR": direction,
        "PHASE_DIR": direction,
        "REFERENCE_DIR": direction,
        "SOURCE_ID": [-1],
        "FLAG_ROW": [False],
    }


def _spectral_window(observation: SimulatedObservation) -> dict[str, object]:
    channels = observation.channels
    width = channels.width.reshape(1, -1)
    return {
        "NAME": ["simulated"],
        "NUM_CHAN": [len(channels)],
        "CHAN_FREQ": channels.frequency.reshape(1, -1),
        "CHAN_WIDTH": width,
        "EFFECTIVE_BW": observation.averaged_width.reshape(1, -1),
        "RESOLUTION": width,
        "REF_FREQUENCY": [float(channels.frequency[0])],
        "TOTAL_BANDWIDTH": [float(channels.width.sum())],
        "MEAS_FREQ_REF": [TOPOCENTRIC],
        "NET_SIDEBAND": [1],
        "FREQ_GROUP": [0],
        "FREQ_GROUP_NAME": [""],
        "IF_CONV_CHAIN": [0],
        "FLAG_ROW": [False],
    }


def _polarization(hands: Hands) -> dict[str, object]:
    return {
        "NUM_CORR": [2],
        "CORR_TYPE": np.array([hands.value], dtype=np.int32),
        "CORR_PRODUCT": np.array([[[0, 0], [1, 1]]], dtype=np.int32),
        "FLAG_ROW": [False],
    }


def _observation(observation: SimulatedObservation) -> dict[str, object]:
    start, stop = _time_range(observation)
    return {
        "TELESCOPE_NAME": [observation.coverage.layout.name],
        "TIME_RANGE": np.array([[start, stop]]),
        "OBSERVER": ["uvshear"],
        "LOG": {"array": [""], "shape": [1, 1]},
        "SCHEDULE_TYPE": [""],
        "SCHEDULE": {"array": [""], "shape": [1, 1]},
        "PROJECT": ["simulation"],
        "RELEASE_DATE": [stop],
        "FLAG_ROW": [False],
    }


def _pointing(observation: SimulatedObservation) -> dict[str, object]:
    count = len(observation.coverage.layout)
    start, stop = _time_range(observation)
    direction = np.tile(np.array(_direction(observation)), (count, 1, 1))
    return {
        "ANTENNA_ID": np.arange(count, dtype=np.int32),
        "TIME": np.full(count, (start + stop) / 2),
        "INTERVAL": np.full(count, stop - start),
        "NAME": ["simulated"] * count,
        "NUM_POLY": np.zeros(count, dtype=np.int32),
        "TIME_ORIGIN": np.full(count, start),
        "DIRECTION": direction,
        "TARGET": direction,
        "TRACKING": np.ones(count, dtype=bool),
    }


def _history(observation: SimulatedObservation) -> dict[str, object]:
    noise = "without noise" if observation.seed is None else f"noise seed {observation.seed}"
    return {
        "TIME": [_time_range(observation)[1]],
        "OBSERVATION_ID": [0],
        "MESSAGE": [
            f"{len(observation.galaxies)} galaxies, {observation.noise!r}, {noise};"
            f" layout: {observation.coverage.layout.source}"
        ],
        "PRIORITY": ["NORMAL"],
        "ORIGIN": ["uvshear.io.measurement_set.writer"],
        "OBJECT_ID": [0],
        "APPLICATION": [f"uvshear {version('uvshear')}"],
        "CLI_COMMAND": {"array": [""], "shape": [1, 1]},
        "APP_PARAMS": {"array": [""], "shape": [1, 1]},
    }
