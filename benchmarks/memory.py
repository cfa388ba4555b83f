"""Peak memory of ``uvshear measure`` for numbers of samples and of sources, and for limits ``--memory-gb``.

    python benchmarks/memory.py [--millions 1 3 10 30] [--counts 100 1000 10000] [--memory-gb 4] [--record memory]

Each field has 2.8 galaxies per square arcminute and is observed by SKA-Mid AA4 for 8 h in one channel; the integration
time sets the number of samples. The memory is that of the process and its copies together, four times a second. It is
the sum of

- the private pages in the proportional set size (PSS), where a page is divided among the processes that share it;
- all pages of shared memory, because one that only an ended copy has touched is in no PSS;
- the pages of files, mostly of libraries, of the process that has most of them, because other programs may share them.

Each case is saved in ``--folder`` as soon as it is measured. The benchmark goes on with the next case if it is started
again at the same commit. Measurement Sets are deleted when their cases are done. The record has every case of the
folder, so that several runs with some of the numbers each make one record.
"""

import argparse
import json
import math
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from record import RESULTS, commit, write_record

OBSERVATION = (
    "--layout ska-mid-aa4 --declination-deg -30 --hours 8 --band-mhz 950 1190 --channels 1"
    " --snr-at 10 10 --seed 1"
)
BASELINES, TRACK_S, DENSITY = 19306, 28800, 2.8
EVERY_S = 0.25
KEPT = ("gb", "wall_s", "samples")


def main() -> None:
    """Simulate, measure, save, write."""
    arguments = parse()
    folder = arguments.folder
    folder.mkdir(parents=True, exist_ok=True)
    is_warm = False
    for millions in arguments.millions:
        for count in arguments.counts:
            for limit in arguments.memory_gb:
                saved = folder / f"{case(millions, count, limit)}.json"
                if (result := load(saved)) is None:
                    if not is_warm:  # compile the kernels
                        measure(simulate(folder, 0.1, 20), 1, arguments.threads)
                        is_warm = True
                    field = simulate(folder, millions, count)
                    result = measure(field, limit, arguments.threads)
                    saved.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
                print(f"{saved.stem}: {result}", flush=True)
            shutil.rmtree(folder / f"{millions}m-{count}.ms", ignore_errors=True)
    if arguments.record:
        write_record(
            RESULTS / f"{arguments.record}.json",
            figures(folder),
            [1],
            title=(
                "Peak memory of uvshear measure and its copies together, by millions of samples, number of sources and"
                f" --memory-gb; {DENSITY} galaxies per square arcminute, {arguments.threads} threads."
            ),
        )


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--millions", type=int, nargs="+", default=[1, 3, 10, 30])
    parser.add_argument("--counts", type=int, nargs="+", default=[100, 1000, 10000])
    parser.add_argument("--memory-gb", type=float, nargs="+", default=[4.0])
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--folder", type=Path, default=Path("memory-cases"))
    parser.add_argument("--record", help="name of a record to write to benchmarks/results")
    return parser.parse_args()


def case(millions: float, count: int, limit: float) -> str:
    """Return the name of a case in the record."""
    return f"{millions:g}m_{count}_within_{limit:g}"


def load(path: Path) -> dict[str, Any] | None:
    """Return what a run at this commit has saved."""
    if not path.exists():
        return None
    result = json.loads(path.read_text(encoding="utf-8"))
    return result if result["commit"] == commit() else None


def figures(folder: Path) -> dict[str, float]:
    """Return the figures of all cases that were measured at this commit."""
    found = {path.stem: load(path) for path in sorted(folder.glob("*_within_*.json"))}
    return {f"{name}_{key}": each[name] for key, each in found.items() if each for name in KEPT}


def simulate(folder: Path, millions: float, count: int) -> Path:
    """Return a Measurement Set with its catalogue beside it; they are simulated if they are not there."""
    path = folder / f"{millions:g}m-{count}.ms"
    integration = TRACK_S / math.ceil(1e6 * millions / BASELINES)
    catalogue = path.with_suffix(".fits")
    if not (path.exists() and catalogue.exists()):
        side = math.sqrt(count / DENSITY)
        run(f"catalogue --field-arcmin {side} --count {count} --seed 1 -o", catalogue)
        run(
            f"simulate {OBSERVATION} --integration-s {integration} --catalogue",
            catalogue,
            "-o",
            path,
        )
    return path


def run(words: str, *paths: str | Path) -> None:
    """Run a command that must succeed."""
    command = [sys.executable, "-m", "uvshear", *words.split(), *map(str, paths), "--overwrite"]
    subprocess.run(command, check=True)


def measure(path: Path, limit: float, threads: int) -> dict[str, Any]:
    """Measure, and return the peak of the memory [GB], its parts and its stage, and the time."""
    log = path.with_name(f"{path.stem}-{limit:g}.log")
    words = f"--memory-gb {limit:g} --threads {threads} --overwrite --log {log}"
    command = [sys.executable, "-m", "uvshear", "measure", str(path), *words.split()]
    command += [
        "--catalogue",
        str(path.with_suffix(".fits")),
        "-o",
        f"{path.with_suffix('')}-shapes.fits",
    ]
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    peak, at, parts = 0.0, 0.0, {}
    while process.poll() is None:
        now, memory = time.monotonic(), memory_of(process.pid)
        if sum(memory.values()) > peak:
            peak, at, parts = sum(memory.values()), now - begin, memory
        time.sleep(EVERY_S)
    wall = time.monotonic() - begin
    assert process.returncode == 0
    records = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    stages = [record for record in records if record["record"] == "stage"]
    # The log begins when the program has been loaded.
    late = wall - records[-1]["seconds"]
    return {
        "gb": peak / 1e9,
        "wall_s": wall,
        "samples": stages[0]["done"],
        "parts_gb": {name: round(size / 1e9, 2) for name, size in parts.items()},
        "stage": stage_at(at - late, stages),
        "own_count_gb": records[-1]["peak_memory_bytes"] / 1e9,
        "commit": commit(),
    }


def stage_at(moment: float, stages: Sequence[dict[str, Any]]) -> str:
    """Return the name of the stage at a moment [s since the beginning of the log]."""
    begun = [stage["stage"] for stage in stages if stage["start"] <= moment]
    return str(begun[-1]) if begun else "start"


def memory_of(pid: int) -> dict[str, float]:
    """Return the memory of a process and of all that come from it [bytes]: private pages, files, shared memory."""
    total = {"anonymous": 0.0, "file": 0.0, "shared": 0.0}
    whole: dict[str, float] = {}
    for each in family(pid):
        with suppress(OSError):  # it has ended
            pss = proportional_sizes(each)
            total["anonymous"] += pss["Pss_Anon"]
            total["file"] = max(total["file"], file_pages(each))
            total["shared"] += pss["Pss_Shmem"]
            whole |= dict(shared_mappings(each))
    return total | {"shared": max(total["shared"], sum(whole.values()))}


def family(pid: int) -> Iterator[int]:
    """Yield a process and all that come from it."""
    children: dict[int, list[int]] = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            # The name of the program, which comes before, may contain spaces.
            parent = int(path.read_text(encoding="utf-8").rpartition(")")[2].split()[1])
            children.setdefault(parent, []).append(int(path.parent.name))
    waiting = [pid]
    while waiting:
        yield (each := waiting.pop())
        waiting += children.get(each, [])


def proportional_sizes(pid: int) -> dict[str, float]:
    """Return the parts of the proportional set size of a process [bytes]."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="utf-8").splitlines()[1:]
    named = (line.split() for line in lines if line.startswith("Pss_"))
    return {name.removesuffix(":"): 1024.0 * int(size) for name, size, _ in named}


def file_pages(pid: int) -> float:
    """Return the pages of files that are in the memory of a process [bytes]."""
    lines = Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines()
    return sum(1024.0 * int(line.split()[1]) for line in lines if line.startswith("RssFile:"))


def shared_mappings(pid: int) -> Iterator[tuple[str, float]]:
    """Yield the numbers of the mappings of shared memory of a process, and their occupied pages [bytes].

    Only the superuser may look at the mappings; for others none is yielded.
    """
    for line in Path(f"/proc/{pid}/maps").read_text(encoding="utf-8").splitlines():
        addresses, rights, _, _, inode, *name = line.split(maxsplit=5)
        if rights.endswith("s") and name and name[0].startswith("/dev/zero"):
            with suppress(OSError):
                first, last = (f"{int(address, 16):x}" for address in addresses.split("-"))
                status = Path(f"/proc/{pid}/map_files/{first}-{last}").stat()
                yield inode, 512.0 * status.st_blocks


if __name__ == "__main__":
    main()
