"""930 million visibilities of MeerKAT, averaged over cells and measured (``uvshear average``).

    python benchmarks/many_samples.py --folder DIR [--parts whole wide tenth nights] [--record many_samples]

300 galaxies and 20 points within 15 arcmin are seen for 8 h, with integrations of 8 s and 128 channels between 856 and
1712 MHz. The observation is simulated in pieces of 0.8 h, which take 2.9 GB each and stay in the folder; those that are
there already are not made again. There are four parts:

- ``whole``: all pieces are averaged together and measured;
- ``wide``: all pieces are averaged for a field of 84 arcmin, which needs 40 GB of disk;
- ``tenth``: the first piece, a tenth of the samples, is measured both directly and from averages;
- ``nights``: further nights repeat the hour angles of the first piece, and are averaged with it and measured.

The figures of each part are saved in the folder with the commit. The record has those of all parts.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from astropy.table import Table
from record import RESULTS, commit, write_record

import uvshear
from uvshear.constants import ARCMIN, ARCSEC

FIELD, WIDE_FIELD = 30, 84
"""Widths of the fields for which visibilities are averaged [arcmin]."""
CENTRE = uvshear.PhaseCentre(0.0, np.radians(-30))
TELESCOPE = (
    "--layout meerkat --declination-deg -30 --integration-s 8 --smearing --band-mhz 856 1712"
    " --channels 128 --snr-at 300 30"
)
PIECES, NIGHTS = 10, 4
HOURS = 0.8
"""Length of a piece; together they are centred on transit."""


@dataclass(frozen=True)
class Run:
    """What a command took."""

    wall_s: float
    cpu_s: float
    gb: float
    text: str


def main() -> None:
    """Simulate what is missing, average, measure, compare, save, write."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--record", help="name of a record to write to benchmarks/results")
    arguments = parser.parse_args()
    folder = arguments.folder
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "sky.fits").exists():
        draw(folder / "sky.fits")
    for part in arguments.parts:
        found = dict(PARTS[part](folder, arguments.threads))
        saved = {"commit": commit(), "figures": found}
        (folder / f"{part}.json").write_text(json.dumps(saved, indent=2), encoding="utf-8")
        for figure, value in found.items():
            print(f"{figure}: {value:.4g}", flush=True)
    if arguments.record:
        saved = {part: load(folder / f"{part}.json") for part in PARTS}
        commits = ", ".join(
            f"{part} {each['commit']}" for part, each in saved.items() if each["commit"]
        )
        write_record(
            RESULTS / f"{arguments.record}.json",
            {name: value for each in saved.values() for name, value in each["figures"].items()},
            [*range(1, PIECES + 1), *range(101, 100 + NIGHTS)],
            title=(
                "uvshear average --field-arcmin 30: MeerKAT, 8 h, integrations of 8 s, 128 channels, 300 galaxies and"
                f" 20 points; {arguments.threads} threads. Commits of the parts: {commits}."
            ),
        )


def load(path: Path) -> dict[str, Any]:
    """Return the commit and the figures of a part; without figures if it was not run."""
    if not path.exists():
        return {"commit": "", "figures": {}}
    return dict(json.loads(path.read_text(encoding="utf-8")))


def whole(folder: Path, threads: int) -> Mapping[str, float]:
    """Average all pieces and measure the averages."""
    pieces, catalogue = (
        [simulated(folder, k, seed=k + 1) for k in range(PIECES)],
        folder / "sky.fits",
    )
    compact = folder / "compact.ms"
    averaged, found = average(pieces, compact, FIELD, threads)
    seen, run = measure(compact, catalogue, threads)
    truth = Table.read(catalogue)
    resolved = np.asarray(truth["scale_length"]) > 0
    good = resolved & (np.asarray(seen["flag"]).astype(str) == "ok")
    pulls = {
        f"pull_{e}": float(np.std((seen[e] - truth[e])[good] / seen[f"{e}_err"][good]))
        for e in ("e1", "e2")
    }
    return {
        "million_samples": found["samples"] / 1e6,
        "million_rows": found["rows"] / 1e6,
        "ratio": found["samples"] / found["rows"],
        "average_s": averaged.wall_s,
        "average_cpu_s": averaged.cpu_s,
        "average_gb": averaged.gb,
        "average_million_per_s": found["samples"] / 1e6 / averaged.wall_s,
        "measure_s": run.wall_s,
        "measure_cpu_s": run.cpu_s,
        "both_min": (averaged.wall_s + run.wall_s) / 60,
        "galaxies_ok": int(np.count_nonzero(good)),
        **pulls,
    }


def wide(folder: Path, threads: int) -> Mapping[str, float]:
    """Average all pieces for a wide field."""
    pieces, compact = [simulated(folder, k, seed=k + 1) for k in range(PIECES)], folder / "wide.ms"
    run, found = average(pieces, compact, WIDE_FIELD, threads)
    shutil.rmtree(compact)
    return {
        "wide_ratio": found["samples"] / found["rows"],
        "wide_s": run.wall_s,
        "wide_gb": run.gb,
    }


def tenth(folder: Path, threads: int) -> Mapping[str, float]:
    """Compare shapes of a piece from the visibilities and from averages, with the same noise."""
    piece, catalogue = simulated(folder, 0, seed=1), folder / "sky.fits"
    compact = folder / "tenth-compact.ms"
    _, found = average([piece], compact, FIELD, threads)
    seen, run = measure(compact, catalogue, threads)
    direct, direct_run = measure(piece, catalogue, threads)
    good = (np.asarray(direct["flag"]).astype(str) == "ok") & (
        np.asarray(seen["flag"]).astype(str) == "ok"
    )
    apart = np.concatenate(
        [(seen[e] - direct[e])[good] / direct[f"{e}_err"][good] for e in ("e1", "e2")]
    )
    return {
        "tenth_ratio": found["samples"] / found["rows"],
        "tenth_galaxies": int(np.count_nonzero(good)),
        "tenth_difference_over_error": float(np.sqrt(np.mean(apart**2))),
        "tenth_largest_difference_over_error": float(np.abs(apart).max()),
        "tenth_error_percent": 100
        * float(np.mean(seen["e1_err"][good] / direct["e1_err"][good]) - 1),
        "tenth_measure_s": run.wall_s,
        "tenth_direct_s": direct_run.wall_s,
        "tenth_direct_cpu_s": direct_run.cpu_s,
    }


def nights(folder: Path, threads: int) -> Mapping[str, float]:
    """Average and measure one, two and all nights of the same hour angles."""
    seen, catalogue = [simulated(folder, 0, seed=1)], folder / "sky.fits"
    seen += [simulated(folder, 0, seed=101 + k) for k in range(NIGHTS - 1)]
    figures: dict[str, float] = {}
    for count in (1, 2, NIGHTS):
        compact = folder / "nights-compact.ms"
        _, found = average(seen[:count], compact, FIELD, threads)
        _, run = measure(compact, catalogue, threads)
        figures |= {
            f"nights_{count}_million_rows": found["rows"] / 1e6,
            f"nights_{count}_measure_s": run.wall_s,
            f"nights_{count}_measure_cpu_s": run.cpu_s,
        }
    return figures


def draw(path: Path) -> None:
    """Write a catalogue of 300 galaxies and 20 points."""
    galaxies = path.with_name("galaxies.fits")
    run_command(
        *("catalogue", "--field-arcmin", FIELD, "--disc", "--count", 300, "--ring", 1),
        *("--flux-ujy", 100, 2000, "--seed", 1, "--overwrite", "-o", galaxies),
    )
    table, rng, count = Table.read(galaxies), np.random.default_rng(2), 20
    radius = 14.8 * ARCMIN * np.sqrt(rng.uniform(size=count))
    angle = rng.uniform(0, 2 * np.pi, count)
    points = np.zeros(count)
    sky = uvshear.Galaxies(
        l=np.concatenate([table["l"], radius * np.cos(angle)]),
        m=np.concatenate([table["m"], radius * np.sin(angle)]),
        flux=np.concatenate([table["flux"], rng.uniform(200, 1000, count)]) * 1e-6,
        scale_length=np.concatenate([table["scale_length"] * ARCSEC, points]),
        ellipticity=np.concatenate([table["e1"] + 1j * table["e2"], points]),
        spectral_index=np.concatenate([table["spectral_index"], table["spectral_index"][:count]]),
    )
    uvshear.write_catalogue(path, uvshear.catalogue_from_galaxies(sky, CENTRE))


PARTS = {"whole": whole, "wide": wide, "tenth": tenth, "nights": nights}


def simulated(folder: Path, piece: int, seed: int) -> Path:
    """Simulate a piece, unless it is there."""
    path = folder / (f"piece-{piece}.ms" if seed == piece + 1 else f"night-{seed}.ms")
    if not path.exists():
        start = -4 + HOURS * piece
        run_command(
            *("simulate", "--catalogue", folder / "sky.fits", *TELESCOPE.split(), "--seed", seed),
            *("--hour-angles", f"{start:.1f}", f"{start + HOURS:.1f}", "-o", path),
        )
    return path


def average(
    pieces: Sequence[Path], compact: Path, field: int, threads: int
) -> tuple[Run, Mapping[str, int]]:
    """Average; return what it took, and the numbers of samples and rows."""
    run = run_command(
        *("average", *pieces, "--field-arcmin", field, "--threads", threads),
        *("--overwrite", "-o", compact),
    )
    told = re.search(r"(\d+) rows from (\d+) visibilities", run.text)
    assert told is not None
    return run, {"rows": int(told[1]), "samples": int(told[2])}


def measure(path: Path, catalogue: Path, threads: int) -> tuple[Table, Run]:
    """Measure with sizes from the catalogue."""
    output = path.with_name(f"{path.stem}-shapes.fits")
    run = run_command(
        *("measure", path, "--catalogue", catalogue, "--size-prior", "catalogue"),
        *("--threads", threads, "--overwrite", "-o", output),
    )
    return Table.read(output), run


def run_command(*words: object) -> Run:
    """Run a command of ``uvshear``; return its time and the memory of its largest process."""
    started = time.perf_counter()
    command = [sys.executable, "-m", "uvshear", *map(str, words)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    text = process.stdout.read() if process.stdout else ""
    print(text, end="", flush=True)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"uvshear {words[0]} failed")
    wall = time.perf_counter() - started
    return Run(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e9, text)


if __name__ == "__main__":
    main()
