"""Sets of four correlations, which are all that DP3 reads."""

import shutil
from pathlib import Path

import numpy as np
from casacore import tables


def with_crossed_hands(path: Path, target: Path) -> None:
    """Copy a set of XX and YY to one with XY and YX, which are zero."""

    def wide(values: np.ndarray) -> np.ndarray:
        four = np.zeros((*values.shape[:-1], 4), values.dtype)
        four[..., [0, 3]] = values
        four[..., [1, 2]] = values[..., [0]] * (values.dtype.kind != "c")
        return four

    description = tables.required_ms_desc("MAIN")
    for name, example, kind in (("DATA", 0j, "complex"), ("WEIGHT_SPECTRUM", 0.0, "float")):
        column = tables.makearrcoldesc(name, example, ndim=2, valuetype=kind)
        description |= tables.maketabdesc(column)
    with (
        tables.table(str(path), ack=False) as main,
        tables.default_ms(str(target), description) as copied,
    ):
        copied.addrows(main.nrows())
        for name in ("DATA", "WEIGHT_SPECTRUM", "FLAG", "WEIGHT", "SIGMA"):
            copied.putcol(name, wide(main.getcol(name)))
        for name in (
            "ANTENNA1",
            "ANTENNA2",
            "TIME",
            "TIME_CENTROID",
            "INTERVAL",
            "EXPOSURE",
            "UVW",
        ):
            copied.putcol(name, main.getcol(name))
        copied.putcol("SCAN_NUMBER", main.getcol("SCAN_NUMBER"))
        for subtable in copied.keywordnames():
            if (path / subtable).is_dir():
                shutil.rmtree(target / subtable)
                shutil.copytree(path / subtable, target / subtable)
    with tables.table(str(target / "POLARIZATION"), readonly=False, ack=False) as hands:
        hands.putcell("NUM_CORR", 0, 4)
        hands.putcell("CORR_TYPE", 0, np.array([9, 10, 11, 12], np.int32))
        hands.putcell("CORR_PRODUCT", 0, np.array([[0, 0], [0, 1], [1, 0], [1, 1]], np.int32))
