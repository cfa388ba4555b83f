"""Averages over cells of (u, v, w) (``uvshear average``): their shapes beside those of the visibilities, and the speed.

    python benchmarks/cells.py [--parts exact noisy] [--record cells]

MeerKAT with integrations of 8 s observes galaxies within 15 arcmin, first without noise, then with noise that leaves a
signal-to-noise ratio of about 100. Galaxies within 42 arcmin follow, without noise and with a signal-to-noise ratio of
2000, whose loss in the cells is part of the model or not; and two spectral indices in an octave of frequencies. The
last set, of 58 million visibilities, is only averaged.
"""

import argparse
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from astropy.table import Table
from record import RESULTS, write_record

import uvshear
from uvshear.averaging.cells import ACCURACY
from uvshear.constants import ARCMIN, ARCSEC

FIELD, WIDE_FIELD = 30, 84
"""Widths of the fields [arcmin]."""
CENTRE = uvshear.PhaseCentre(0.3, math.radians(-30))
TELESCOPE = "--layout meerkat --declination-deg -30 --integration-s 8 --smearing --seed 1"
EXACT = f"{TELESCOPE} --hours 1.2 --band-mhz 1200 1290 --channels 8 --snr-at 1000 2000 --no-noise"
NOISY = f"{TELESCOPE} --hours 1 --band-mhz 1200 1260 --channels 6 --snr-at 1000 60"
WIDE = "--layout meerkat --declination-deg -30 --integration-s 8 --seed 1 --hours 1"
WIDE = f"{WIDE} --band-mhz 1200 1260 --channels 6 --snr-at 1000 2000 --no-noise"
SPECTRA = (
    f"{TELESCOPE} --hours 0.08 --band-mhz 856 1712 --channels 128 --snr-at 1000 200 --no-noise"
)
MANY = f"{TELESCOPE} --hours 2 --band-mhz 856 1712 --channels 32 --snr-at 1000 60"
FINE = 0.02
"""An accuracy with which shapes are the same to a fiftieth of their errors or so."""


def main() -> None:
    """Simulate, average, measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--parts", nargs="+", choices=[*PARTS, "speed"], default=[*PARTS, "speed"])
    parser.add_argument("--record", help="name of a record to write to benchmarks/results")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        figures: dict[str, float] = {}
        for part in arguments.parts:
            threads = arguments.threads
            figures |= speed(folder, threads) if part == "speed" else PARTS[part](folder)
    for figure, value in figures.items():
        print(f"{figure}: {value:.4g}")
    if arguments.record:
        write_record(
            RESULTS / f"{arguments.record}.json",
            figures,
            [5, 1],
            title=(
                "uvshear average, MeerKAT, integrations of 8 s, fields of 30 and 84 arcmin:"
                f" {', '.join(arguments.parts)}; {arguments.threads} threads."
            ),
        )


def exact(folder: Path) -> dict[str, float]:
    """Return the largest errors of ellipticities without noise, and the largest difference of the PSF."""
    catalogue, truth = draw(folder / "exact.fits", 12)
    seen, compact = simulate(folder / "exact.ms", catalogue, EXACT), folder / "exact-compact.ms"
    run("average", seen, "--field-arcmin", FIELD, "-o", compact)
    found = {}
    for figure, path in (("direct_de", seen), ("averaged_de", compact)):
        table = measured(path, catalogue)
        found[figure] = float(np.abs(table["e1"] + 1j * table["e2"] - truth).max())
    grid = uvshear.ImageGrid(512, ARCSEC)
    psf, other = (
        uvshear.point_spread_function(uvshear.open_observation(path), grid)
        for path in (seen, compact)
    )
    return found | {"psf_difference": float(np.abs(psf - other).max() / psf.max())}


def noisy(folder: Path) -> dict[str, float]:
    """Compare shapes of the same visibilities, averaged and not."""
    catalogue, _ = draw(folder / "noisy.fits", 40)
    seen = simulate(folder / "noisy.ms", catalogue, NOISY)
    direct = measured(seen, catalogue)
    found: dict[str, float] = {}
    for name, accuracy in (("default", ACCURACY), ("fine", FINE)):
        compact = folder / f"{name}.ms"
        count = uvshear.average(
            seen, compact, field_arcmin=FIELD, accuracy=accuracy, overwrite=True
        )
        table = measured(compact, catalogue)
        apart = [(table[e] - direct[e]) / direct[f"{e}_err"] for e in ("e1", "e2")]
        found |= {
            f"{name}_ratio": count.samples / count.rows,
            f"{name}_difference_over_error": float(np.sqrt(np.mean(np.square(apart)))),
            f"{name}_error_percent": 100 * float(np.mean(table["e1_err"] / direct["e1_err"]) - 1),
        }
    return found


def wide(folder: Path) -> dict[str, float]:
    """Return the largest errors of ellipticities in a wide field, with the loss in the cells in the model and without.

    The correlator averages over nothing, so that ``--no-smearing`` leaves out the loss in the cells alone.
    """
    catalogue, truth = draw(folder / "wide.fits", 12, radius_arcmin=41.5)
    seen, compact = simulate(folder / "wide.ms", catalogue, WIDE), folder / "wide-compact.ms"
    count = uvshear.average(seen, compact, field_arcmin=WIDE_FIELD)
    found = {"wide_ratio": count.samples / count.rows}
    for figure, path, *words in (
        ("wide_direct_de", seen),
        ("wide_averaged_de", compact),
        ("wide_unmodelled_de", compact, "--no-smearing"),
    ):
        table = measured(path, catalogue, *words)
        error = np.abs(table["e1"] + 1j * table["e2"] - truth)
        found[figure] = float(np.nanmax(error))
        found[f"{figure}_flagged"] = int(np.count_nonzero(table["flag"] != "ok"))
    return found


def spectra(folder: Path) -> dict[str, float]:
    """Return the largest errors of ellipticities of galaxies with spectra of two kinds, directly and from averages.

    The last figure of each kind is the largest difference of the two.
    """
    found = {}
    for kind, index in (("steep", -1.2), ("flat", -0.2)):
        catalogue, truth = draw(folder / f"{kind}.fits", 12, spectral_index=index)
        seen, compact = folder / f"{kind}.ms", folder / f"{kind}-compact.ms"
        simulate(seen, catalogue, SPECTRA)
        uvshear.average(seen, compact, field_arcmin=FIELD)
        tables = [measured(path, catalogue) for path in (seen, compact)]
        direct, averaged = (table["e1"] + 1j * table["e2"] - truth for table in tables)
        found[f"{kind}_direct_de"] = float(np.abs(direct).max())
        found[f"{kind}_averaged_de"] = float(np.abs(averaged).max())
        found[f"{kind}_change"] = float(np.abs(averaged - direct).max())
    return found


def speed(folder: Path, threads: int) -> dict[str, float]:
    """Average a large set; return its number of visibilities and the time."""
    catalogue, _ = draw(folder / "many.fits", 12)
    seen = simulate(folder / "many.ms", catalogue, MANY)
    before, wall = os.times(), time.perf_counter()
    run(
        *("average", seen, "--field-arcmin", FIELD, "--threads", threads),
        *("-o", folder / "many-compact.ms"),
    )
    wall, after = time.perf_counter() - wall, os.times()
    cpu = after.children_user + after.children_system
    cpu -= before.children_user + before.children_system
    samples = uvshear.inspect(seen).fields[0].counts.usable
    return {
        "speed_million_samples": samples / 1e6,
        "speed_wall_s": wall,
        "speed_cpu_s": cpu,
        "speed_million_per_s": samples / 1e6 / wall,
    }


def draw(
    path: Path, count: int, *, radius_arcmin: float = 14.8, spectral_index: float = -0.7
) -> tuple[Path, np.ndarray]:
    """Write a catalogue of galaxies on a spiral; return their ellipticities as well."""
    rng, number = np.random.default_rng(5), np.arange(count)
    radius = np.sqrt(np.linspace(0.05, 1, count)) * radius_arcmin * ARCMIN
    e = 0.35 * np.sqrt(rng.uniform(0.1, 1, count)) * np.exp(2j * np.pi * rng.uniform(size=count))
    galaxies = uvshear.Galaxies(
        l=radius * np.cos(2.4 * number),
        m=radius * np.sin(2.4 * number),
        flux=np.full(count, 1e-3),
        scale_length=4 * ARCSEC * rng.uniform(0.9, 1.2, count),
        ellipticity=e,
        spectral_index=np.full(count, spectral_index),
    )
    uvshear.write_catalogue(path, uvshear.catalogue_from_galaxies(galaxies, CENTRE))
    return path, e


def simulate(path: Path, catalogue: Path, words: str) -> Path:
    run("simulate", "--catalogue", catalogue, *words.split(), "-o", path)
    return path


def measured(path: Path, catalogue: Path, *words: str) -> Table:
    """Measure with sizes from the catalogue."""
    output = path.with_name(f"{path.stem}-shapes.fits")
    sizes = ("--size-prior", "catalogue", "--overwrite", *words)
    run("measure", path, "--catalogue", catalogue, *sizes, "-o", output)
    return Table.read(output)


def run(*words: object) -> None:
    subprocess.run([sys.executable, "-m", "uvshear", *map(str, words)], check=True)


PARTS = {"exact": exact, "noisy": noisy, "wide": wide, "spectra": spectra}


if __name__ == "__main__":
    main()
