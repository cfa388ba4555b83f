"""The whole chain of a survey: simulate, image with wsclean, find with PyBDSF, measure, shear.

    make chain
    python benchmarks/chain.py chain --field-arcmin 20 --overwrite

Every step is a command that is printed as a user would type it. The same field is measured with PyBDSF's catalogue and
with the true one; ``chain.json`` has how complete the former is, and by how much it shifts the slopes of measured
against true ellipticity. wsclean and PyBDSF are needed (``make referees``).
"""

import argparse
import json
import math
import shlex
import shutil
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
from astropy.table import Table
from scipy.spatial import cKDTree

from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.diagnostics.slope import fit_slope, population_weights
from uvshear.galaxy import Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.io.catalogue import read_catalogue
from uvshear.io.shapes import inside, read_shapes
from uvshear.simulation.lensing import shear_galaxies

PHASE_CENTRE = PhaseCentre(0.0, math.radians(-30.0))
SHEAR = 0.05 - 0.03j

PIXEL = 0.5
"""Of the image [arcsec]."""

IMAGING = (
    "-quiet -no-update-model-required -use-wgridder -name image -weight briggs 0"
    " -taper-gaussian 1.8asec -minuv-l 1000 -niter 50000 -mgain 0.8 -auto-threshold 3 -auto-mask 5"
)
"""A beam of 6 arcsec: wide enough for galaxies of a few, narrow enough to tell them apart. The core of the array, which
would make it wider still, is left out."""

FINDING = """
import bdsf
image = bdsf.process_image("image-image.fits", thresh_isl=3.0, thresh_pix=5.0, thresh="hard", rms_map=False,
                           mean_map="zero", ncores=2, quiet=True)
image.write_catalog(outfile="found.fits", format="fits", catalog_type="gaul", clobber=True)
"""
"""Gaussians, not sources: what overlaps at 6 arcsec is two galaxies more often than one."""

UV_MIN = 6000
"""Of the measurement [wavelengths]: sources that no catalogue has add up on shorter baselines."""

SAME = 1.0
"""Entries of the catalogue within this distance of a galaxy are that galaxy [arcsec]."""

BESIDE = 10.0
"""Galaxies within this distance of one another may have been taken for one [arcsec]."""

SNR_MIN = 20.0

AGREE = 0.3
"""Part of its flux in the catalogue by which a source's fitted flux may differ: of two galaxies that the finder took
for one, or one that it took for two, it differs by more."""

BINS = (10, 20, 50, 200)
"""Of the true flux [uJy]."""


def main() -> None:
    """Run the chain, compare, print, write ``chain.json``."""
    arguments = parse()
    if shutil.which("wsclean") is None:
        sys.exit("wsclean is missing: make referees installs it")
    directory, start = arguments.directory, time.perf_counter()
    if directory.exists():
        if not arguments.overwrite:
            sys.exit(f"{directory}: exists already; give --overwrite or another directory")
        shutil.rmtree(directory)
    directory.mkdir(parents=True)
    observe(directory, arguments.field_arcmin, arguments.threads)
    for name in ("true", "found"):
        measure(directory, name, arguments.threads)
    result = compare(directory) | {"seconds": round(time.perf_counter() - start)}
    (directory / "chain.json").write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    print(json.dumps(result, indent=2))


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("directory", type=Path)
    parser.add_argument("--field-arcmin", type=float, default=20.0)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--overwrite", action="store_true")
    return parser.parse_args()


def observe(directory: Path, field_arcmin: float, threads: int) -> None:
    """Simulate the field, image it, find its sources."""
    uvshear(
        directory,
        f"catalogue --field-arcmin {field_arcmin:g} --density 2.8 --flux-ujy 10 200 --seed 1 -o true.fits",
    )
    uvshear(
        directory,
        "simulate --layout ska-mid-aa4 --catalogue true.fits --declination-deg -30 --hours 8 --integration-s 600"
        f" --band-mhz 950 1190 --channels 1 --shear {SHEAR.real:g} {SHEAR.imag:g} --snr-at 10 10 --seed 1"
        f" --threads {threads} -o field.ms",
    )
    size = 2 * round(0.55 * field_arcmin * 60 / PIXEL)
    command = f"wsclean -j {threads} -size {size} {size} -scale {PIXEL:g}asec {IMAGING} field.ms"
    run(directory, shlex.split(command), command)
    (directory / "find.py").write_text(FINDING, encoding="utf-8")
    run(directory, [sys.executable, "find.py"], "python find.py")


def measure(directory: Path, name: str, threads: int) -> None:
    """Measure with a catalogue, and estimate the shear."""
    uvshear(
        directory,
        f"measure field.ms --catalogue {name}.fits --uv-min {UV_MIN} --threads {threads} -o shapes-{name}.fits",
    )
    uvshear(directory, f"shear shapes-{name}.fits --snr-min {SNR_MIN:g} -o shear-{name}.json")


def uvshear(directory: Path, arguments: str) -> None:
    program = str(Path(sys.executable).with_name("uvshear"))
    run(directory, [program, *arguments.split()], f"uvshear {arguments}")


def run(directory: Path, command: list[str], shown: str) -> None:
    print(f"\n$ {shown}", flush=True)
    subprocess.run(command, cwd=directory, check=True)


def compare(directory: Path) -> dict[str, object]:
    """Set what came of PyBDSF's catalogue against the truth, and against what came of the true one."""
    intrinsic = read_catalogue(directory / "true.fits").galaxies(PHASE_CENTRE)
    galaxies = shear_galaxies(intrinsic, SHEAR)
    with_true, with_found = (
        read_shapes(directory / f"shapes-{name}.fits") for name in ("true", "found")
    )
    entry, galaxy, far = match(galaxies, with_found)
    frequency = read_catalogue(directory / "found.fits").reference_frequency
    ratio = inside(with_found, "flux")[entry] / flux_at(galaxies, frequency)[galaxy]
    result = {"entries": len(with_found), "of_no_galaxy": far}
    result |= completeness(galaxies, galaxy, ratio)
    both = with_true[galaxy], with_found[entry]
    chosen = {
        "slopes": np.ones(len(galaxy), bool),
        "slopes_where_fluxes_agree": np.abs(
            inside(both[1], "flux_fit") / inside(both[1], "flux") - 1
        )
        < AGREE,
        "slopes_next_to_missed_ones": beside_missed(galaxies, galaxy),
    }
    e = galaxies.ellipticity[galaxy]
    return result | {name: slopes(e, *both, which) for name, which in chosen.items()}


def beside_missed(galaxies: Galaxies, found: np.ndarray) -> np.ndarray:
    """Which of the galaxies found have one within ``BESIDE`` that was not."""
    place = np.column_stack([galaxies.l, galaxies.m])
    missed = np.setdiff1d(np.arange(len(galaxies)), found)
    apart, _ = cKDTree(place[missed]).query(place[found])
    return apart < BESIDE * ARCSEC


def flux_at(galaxies: Galaxies, frequency: float) -> np.ndarray:
    return galaxies.flux * (frequency / galaxies.reference_frequency) ** galaxies.spectral_index


def match(galaxies: Galaxies, found: Table) -> tuple[np.ndarray, np.ndarray, int]:
    """Entries of the catalogue, the galaxies they are (each once, its nearest entry), and how many are no galaxy's."""
    place = np.column_stack([inside(found, "l"), inside(found, "m")])
    apart, galaxy = cKDTree(np.column_stack([galaxies.l, galaxies.m])).query(place)
    near = np.argsort(apart, kind="stable")
    near = near[apart[near] < SAME * ARCSEC]
    _, first = np.unique(galaxy[near], return_index=True)
    entry = near[first]
    return entry, galaxy[entry], len(found) - len(near)


def completeness(galaxies: Galaxies, galaxy: np.ndarray, ratio: np.ndarray) -> dict[str, object]:
    bins = {}
    for low, high in pairwise(BINS):
        there, seen = (
            (flux >= low * MICROJANSKY) & (flux < high * MICROJANSKY)
            for flux in (galaxies.flux, galaxies.flux[galaxy])
        )
        bins[f"{low}-{high} uJy"] = {
            "galaxies": int(there.sum()),
            "complete": round(float(seen.sum() / there.sum()), 3),
            "flux_over_true": round(float(np.median(ratio[seen])), 3),
        }
    return {"by_flux": bins}


def slopes(
    true: np.ndarray, with_true: Table, with_found: Table, chosen: np.ndarray
) -> dict[str, float]:
    """Slopes of the galaxies above the SNR that both have measured, and their difference."""
    measured = np.array((with_true["flag"] == "ok") & (with_found["flag"] == "ok"))
    chosen = chosen & measured & (inside(with_true, "snr") > SNR_MIN)
    result: dict[str, float] = {"galaxies": int(chosen.sum())}
    for name, part in (("e1", true.real[chosen]), ("e2", true.imag[chosen])):
        ours, theirs = (inside(table, name)[chosen] for table in (with_true, with_found))
        error = inside(with_true, f"{name}_err")[chosen]
        for which, value in (("true", ours), ("found", theirs), ("shift", theirs - ours)):
            slope = fit_slope(part, value, error, population_weights)
            result[f"{name}_{which}"] = round(slope.value, 4)
            result[f"{name}_{which}_err"] = round(slope.error, 4)
    return result


if __name__ == "__main__":
    main()
