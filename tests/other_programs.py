"""Other programs, which tests run in processes of their own, without a network."""

import os
import subprocess
import sys
from pathlib import Path

CASA_CONFIGURATION = """
from casadata import datapath as _tables
measurespath = _tables
datapath = [_tables]
measures_auto_update = data_auto_update = False
skipnetworkcheck = True
nologfile = log2term = agg = True
logfile = "/dev/null"
casaconfig_verbose = 0
"""
"""CASA takes its tables from the package casadata, and neither updates them nor writes a file of its log."""

PYUVDATA_PREAMBLE = """
import warnings
warnings.simplefilter("ignore")
from astropy.coordinates import EarthLocation
from astropy.coordinates.sites import SiteRegistry
from astropy.utils import iers
iers.conf.auto_download = False
EarthLocation._site_registry = SiteRegistry()
EarthLocation._site_registry.add_site(["Null Island"], EarthLocation.from_geodetic(0, 0))
from pyuvdata import UVData
"""
"""pyuvdata asks astropy for all sites of telescopes, which astropy would fetch."""


def run_casa(script: str, directory: Path) -> None:
    """Run a script of CASA's tasks and tools. (CASA and python-casacore bring a casacore each, one a process.)"""
    configuration = directory / "casasiteconfig.py"
    configuration.write_text(CASA_CONFIGURATION)
    _run([sys.executable, "-c", script], directory, CASASITECONFIG=str(configuration))


def run_pyuvdata(script: str, directory: Path) -> None:
    """Run a script that uses ``UVData``."""
    _run([sys.executable, "-c", PYUVDATA_PREAMBLE + script], directory)


def run_dp3(*settings: str, directory: Path) -> None:
    """Run DP3, which refuses to run beside threads of the linear algebra."""
    program = str(Path(sys.executable).with_name("DP3.py"))
    _run([program, *settings, "numthreads=2"], directory, OPENBLAS_NUM_THREADS="1")


def _run(command: list[str], directory: Path, **variables: str) -> None:
    done = subprocess.run(
        command,
        check=False,
        timeout=600,
        capture_output=True,
        text=True,
        cwd=directory,
        # CASA reads ~/.casa/config.py as well
        env=os.environ | {"HOME": str(directory), "OMP_NUM_THREADS": "1"} | variables,
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
