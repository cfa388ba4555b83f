"""Measurement Sets as observatories deliver them: several windows, four correlations, rows in any order."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from casacore import tables

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Coverage
from uvshear.interferometer.spectral_window import Channels

CIRCULAR = (5, 6, 7, 8)
LINEAR = (9, 10, 11, 12)


@dataclass(frozen=True)
class Window:
    """Channels of a spectral window, and Stokes I on them, row by row of the coverage [Jy]."""

    channels: Channels
    stokes_i: np.ndarray


def write_varied(
    path: Path,
    coverage: Coverage,
    windows: list[Window],
    *,
    correlations: tuple[int, ...] = LINEAR,
    sigma: float = 1e-3,
    by_baseline: bool = False,
    scans: int = 1,
) -> Path:
    """Write a set whose parallel hands are Stokes I plus and minus a half of it, the others noise.

    ``sigma`` is of one component of a correlation [Jy]; rows of all windows are mixed.
    """
    rows = len(coverage)
    description = tables.required_ms_desc("MAIN")
    for name in ("DATA", "WEIGHT_SPECTRUM"):
        kind, example = ("complex", 0j) if name == "DATA" else ("float", 0.0)
        column = tables.makearrcoldesc(name, example, ndim=2, valuetype=kind)
        description |= tables.maketabdesc(column)
    with tables.default_ms(str(path), description) as main:
        main.addrows(rows * len(windows))
        window = np.tile(np.arange(len(windows)), rows)
        row = np.repeat(np.arange(rows), len(windows))
        if by_baseline:
            order = np.lexsort(
                (window, coverage.time[row], coverage.antenna2[row], coverage.antenna1[row])
            )
            window, row = window[order], row[order]
        main.putcol("ANTENNA1", coverage.antenna1[row])
        main.putcol("ANTENNA2", coverage.antenna2[row])
        main.putcol("UVW", coverage.uvw[row])
        main.putcol("DATA_DESC_ID", window)
        main.putcol("FIELD_ID", np.zeros(len(row), int))
        for name in ("TIME", "TIME_CENTROID"):
            main.putcol(name, coverage.time[row])
        main.putcol("INTERVAL", np.full(len(row), coverage.integration))
        main.putcol("EXPOSURE", np.zeros(len(row)))
        main.putcol("SCAN_NUMBER", 1 + row * scans // rows)
        main.putcol("FLAG_ROW", np.zeros(len(row), bool))
        rng = np.random.default_rng(5)
        for k, (one, of) in enumerate(zip(row.tolist(), window.tolist(), strict=True)):
            _put(main, k, windows[of].stokes_i[one], correlations, sigma, rng)
    _describe(path, coverage, windows, correlations)
    return path


def _put(main, k, stokes_i, correlations, sigma, rng) -> None:
    noise = 1e-2 * rng.standard_normal((len(stokes_i), len(correlations)))
    data = noise.astype(complex)
    # a source that is polarised: only the mean of both hands is Stokes I
    data[:, 0], data[:, -1] = 1.5 * stokes_i, 0.5 * stokes_i
    shape = data.shape
    main.putcell("DATA", k, data.astype(np.complex64))
    main.putcell("FLAG", k, np.zeros(shape, bool))
    main.putcell("WEIGHT_SPECTRUM", k, np.full(shape, sigma**-2, np.float32))
    main.putcell("WEIGHT", k, np.full(shape[1], sigma**-2, np.float32))
    main.putcell("SIGMA", k, np.full(shape[1], sigma, np.float32))


def _describe(path: Path, coverage: Coverage, windows, correlations) -> None:
    centre: PhaseCentre = coverage.phase_centre
    direction = np.array([[centre.ra, centre.dec]])
    with tables.table(str(path / "FIELD"), readonly=False, ack=False) as table:
        table.addrows(1)
        table.putcell("NAME", 0, "varied")
        for name in ("PHASE_DIR", "DELAY_DIR", "REFERENCE_DIR"):
            table.putcell(name, 0, direction)
    with tables.table(str(path / "ANTENNA"), readonly=False, ack=False) as table:
        layout = coverage.layout
        table.addrows(len(layout))
        table.putcol("POSITION", layout.positions)
        table.putcol("DISH_DIAMETER", layout.diameters)
    with tables.table(str(path / "POLARIZATION"), readonly=False, ack=False) as table:
        table.addrows(1)
        table.putcell("NUM_CORR", 0, len(correlations))
        table.putcell("CORR_TYPE", 0, np.array(correlations, np.int32))
    with (
        tables.table(str(path / "SPECTRAL_WINDOW"), readonly=False, ack=False) as spectral,
        tables.table(str(path / "DATA_DESCRIPTION"), readonly=False, ack=False) as table,
    ):
        for k, window in enumerate(windows):
            spectral.addrows(1)
            table.addrows(1)
            spectral.putcell("NUM_CHAN", k, len(window.channels))
            spectral.putcell("CHAN_FREQ", k, window.channels.frequency)
            spectral.putcell("CHAN_WIDTH", k, window.channels.width)
            spectral.putcell("EFFECTIVE_BW", k, np.zeros(len(window.channels)))
            table.putcell("SPECTRAL_WINDOW_ID", k, k)
            table.putcell("POLARIZATION_ID", k, 0)
    with tables.table(str(path / "OBSERVATION"), readonly=False, ack=False) as table:
        table.addrows(1)
        table.putcell("TELESCOPE_NAME", 0, coverage.layout.name)
