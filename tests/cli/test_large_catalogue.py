"""A catalogue of a million sources of the whole sky, of which three are in the field."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table

from tests.cli.processes import COMMAND, environment

ROWS = 10**6
FAR = 6.0
"""Distance from the field of all others [deg]; sources within 5 degrees are modelled."""


def _catalogue(path: Path) -> None:
    rng = np.random.default_rng(1)
    dec = np.degrees(np.arcsin(rng.uniform(-1, 1, ROWS)))
    ra = rng.uniform(0, 360, ROWS)
    near = (np.abs(dec + 30) < FAR) & (np.abs((ra + 180) % 360 - 180) < 2 * FAR)
    dec[near] += 60
    ra[:3], dec[:3] = [1e-3, 5e-3, 9e-3], [-30.004, -29.996, -30.001]
    table = Table({"id": np.arange(ROWS), "ra": ra, "dec": dec, "flux": rng.uniform(50, 200, ROWS)})
    table["flux"].unit = "uJy"
    table["ra"].unit = table["dec"].unit = "deg"
    table.write(path)
    table[:3].write(path.with_name("few.fits"))


@pytest.mark.long
def test_memory_does_not_grow_with_sources_outside_the_field(tmp_path: Path, layout: Path) -> None:
    _catalogue(tmp_path / "all.fits")
    words = f"""simulate --layout {layout} --catalogue few.fits --declination-deg -30 --ra-deg 0 --hours 4
        --integration-s 600 --band-mhz 950 1190 --channels 4 --snr-at 50 50 -o field.ms"""
    subprocess.run([*COMMAND, *words.split()], check=True, cwd=tmp_path, env=environment())
    peaks = {}
    for name in ("few", "all"):
        words = f"measure field.ms --catalogue {name}.fits --memory-gb 0.8 --threads 1 -o {name}-shapes.fits"
        started = subprocess.Popen([*COMMAND, *words.split()], cwd=tmp_path, env=environment())
        _, status, used = os.wait4(started.pid, 0)
        started.returncode = os.waitstatus_to_exitcode(status)
        assert started.returncode == 0
        peaks[name] = used.ru_maxrss / 1e6
    few, everything = (Table.read(tmp_path / f"{name}-shapes.fits") for name in ("few", "all"))
    assert len(everything) == ROWS
    for column in ("e1", "e2", "flux_fit"):
        np.testing.assert_array_equal(everything[column][:3], few[column])
    # measured 0.45 and 1.50 GB
    assert peaks["all"] < 0.8 + 1.0
