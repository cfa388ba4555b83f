"""Small Measurement Sets, built by the tests that read them."""

import shutil
import tarfile
from pathlib import Path

import numpy as np
import pytest
from casacore import tables

from uvshear.galaxy import Exponential, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import CorrelationNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.simulation.observation import SimulatedObservation

REAL = Path(__file__).parents[3] / "shared" / "data" / "real"


PHASE_CENTRE = PhaseCentre(1.0, -0.5)
SEFD = ((13.5, 500.0), (15.0, 320.0))


def simulated(
    seed: int | None = 1,
    channels: int = 4,
    layout: str = "ska-mid-aa1",
    *,
    is_averaged: bool = False,
):
    """An observation of 28 baselines and 60 integrations."""
    track = Track.from_clock(PHASE_CENTRE, ((-1800.0, 1800.0),), 60.0)
    galaxies = Galaxies(
        l=np.array([1e-3, -4e-4]),
        m=np.array([2e-3, 3e-4]),
        flux=np.array([1e-3, 2e-3]),
        scale_length=np.array([0.0, 5e-6]),
        ellipticity=np.array([0, 0.2 + 0.1j]),
        spectral_index=np.array([-0.7, -0.7]),
    )
    return SimulatedObservation(
        coverage=synthesise(load_layout(layout), track),
        channels=Channels.from_band(950e6, 1190e6, channels),
        galaxies=galaxies,
        profile=Exponential(),
        noise=CorrelationNoise(SEFD),
        seed=seed,
        is_averaged=is_averaged,
    )


def written(directory: Path, **changes) -> Path:
    """Write the simulated observation."""
    path = directory / "field.ms"
    write_measurement_set(path, simulated(**changes))
    return path


def change(path: Path, column: str, value, rows=None, subtable: str = "") -> None:
    """Set cells of a column to a value."""
    with tables.table(str(path / subtable), readonly=False, ack=False) as table:
        values = table.getcol(column)
        values[slice(None) if rows is None else rows] = value
        table.putcol(column, values)


def with_rows(ms, rows):
    """A copy of a set that has only some of its rows."""
    path = ms.with_name("selected.ms")
    with tables.table(str(ms), ack=False) as main:
        main.selectrows(np.sort(rows)).copy(str(path), deep=True).close()
    return path


def averaged_by_baseline(directory: Path) -> Path:
    """Write a set whose short baselines are averaged over twice the time of the others, and have times of their own."""
    ms = written(directory, is_averaged=True)
    with tables.table(str(ms), readonly=False, ack=False) as main:
        first, second, time = (main.getcol(name) for name in ("ANTENNA1", "ANTENNA2", "TIME"))
        short = (second - first == 1).nonzero()[0]
        even = np.isin(time[short], np.unique(time)[::2])
        for name in ("EXPOSURE", "INTERVAL"):
            values = main.getcol(name)
            values[short] = 120.0
            main.putcol(name, values)
        time[short] += 30.0
        main.putcol("TIME", time)
    return with_rows(ms, np.setdiff1d(np.arange(1680), short[~even]))


def edited(path: Path, subtable: str = "") -> tables.table:
    """Open a table for changes."""
    return tables.table(str(path / subtable), readonly=False, ack=False)


def emptied(path: Path, subtable: str) -> None:
    """Replace a subtable by one without rows. (casacore forgets that rows were removed if none is left.)"""
    with tables.table(str(path / subtable), ack=False) as table:
        description = table.getdesc()
    shutil.rmtree(path / subtable)
    tables.table(str(path / subtable), description, nrow=0, ack=False).close()


def real_set(tmp_path, archive):
    if not REAL.is_dir():
        pytest.skip(f"no {REAL}: the real sets do not come with the package")
    with tarfile.open(REAL / archive) as tar:
        tar.extractall(tmp_path, filter="data")
    return next(entry for entry in tmp_path.iterdir() if (entry / "table.dat").is_file())
