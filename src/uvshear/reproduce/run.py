"""The reproduction of the paper from end to end."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from uvshear import __version__
from uvshear.errors import InputError
from uvshear.execution import SERIAL, Resources, single_threaded_libraries
from uvshear.io.outputs import write_json
from uvshear.io.part_files import PartFiles
from uvshear.io.provenance import Provenance
from uvshear.plot import save
from uvshear.progress import Meter, Progress, Stage
from uvshear.reproduce.names import QUICK, TARGETS
from uvshear.reproduce.page import write_page
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.registry import targets_at
from uvshear.reproduce.reproduced_target import ReproducedTarget
from uvshear.typing import Array

PARTS: Final = "parts"
"""Directory of the parts within that of the results."""

PAGE: Final = "index.md"

_SECONDS: Final = "seconds"


def reproduce_paper(
    directory: str | Path,
    targets: Sequence[str] = (),
    *,
    scale: str = QUICK,
    seed: int = 1,
    resources: Resources | None = None,
    progress: Progress | None = None,
    provenance: Provenance | None = None,
    overwrite: bool = False,
) -> Path:
    """Reproduce tables and figures of Rivi & Miller 2018, and write a page that compares them with the paper.

    Parts that an earlier run with the same options has left in the directory are used.

    Parameters
    ----------
    directory
        Directory for the page, the pictures, the numbers and the parts; it is made if needed.
    targets
        Names of the targets; all of them unless given.
    scale
        "quick", or "paper" for the numbers of galaxies of the paper.
    seed
        Seed of the random numbers.
    resources
        Workers and memory that may be used.
    progress
        Function called with the work done so far and the total work.
    provenance
        Origin of the results, for their files.
    overwrite
        Whether to begin anew where there are parts of these targets.

    Returns
    -------
        Path of the page.

    Raises
    ------
    InputError
        A target is not known, the directory cannot be used, or it has parts that were computed with other options.
    """
    place = Path(directory)
    chosen = targets_at(scale, tuple(targets), seed)
    stores = [_store(place, target, scale) for target in chosen]
    _check_place(place, stores, overwrite=overwrite)
    made = provenance or Provenance("uvshear.reproduce_paper", (), {"scale": scale, "seed": seed})
    meter = Meter(progress)
    stages = [
        Stage(target.name, target.seconds(), float(len(target.tasks())), "parts")
        for target in chosen
    ]
    for k, (target, store) in enumerate(zip(chosen, stores, strict=True)):
        meter.begin(*stages[k:])
        found = _compute(target, store, resources or Resources(), meter)
        _write(place, target, scale, found, made)
    meter.finish()
    page = place / PAGE
    known = (place / f"{name}.json" for name in TARGETS)
    write_page(page, [ReproducedTarget.read(path) for path in known if path.exists()])
    return page


def _store(place: Path, target: PaperTarget, scale: str) -> PartFiles:
    identity = {"version": __version__, "scale": scale, **target.settings()}
    return PartFiles(place / PARTS / target.name, identity)


def _check_place(place: Path, stores: Sequence[PartFiles], *, overwrite: bool) -> None:
    """Refuse a directory that cannot be used, before anything is computed."""
    if place.exists() and not place.is_dir():
        raise InputError(f"{place}: is a file; a directory is needed")
    if (place / PAGE).exists() and not (place / PARTS).is_dir() and not overwrite:
        raise InputError(
            f"{place / PAGE}: exists already, and is not from such a run; give --overwrite (overwrite=True) or another"
            " directory"
        )
    for store in stores:
        if overwrite:
            store.remove()
        store.check()
    try:
        (place / PARTS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{place}: cannot be created: {error.strerror or error}") from error


def _compute(
    target: PaperTarget, store: PartFiles, resources: Resources, meter: Meter
) -> dict[str, dict[str, Array]]:
    tasks = target.tasks()
    missing = [name for name in tasks if name not in store]
    # Parts of an earlier run tell nothing of the speed of this one.
    meter.expect(len(missing) - len(tasks))
    executor = SERIAL if target.is_alone else resources.executor
    with single_threaded_libraries():
        measured = executor.distribute(_measured, target, [tasks[name] for name in missing])
        for name, values in zip(missing, measured, strict=True):
            store.save(name, values)
            meter.add(1)
    return {name: store.load(name) for name in tasks}


def _measured(target: PaperTarget, task: Any) -> dict[str, Array]:
    """Compute a part in a worker, with the processor time that it takes."""
    start = time.process_time()
    found = dict(target.measure(task))
    return found | {_SECONDS: np.array(time.process_time() - start)}


def _write(
    place: Path,
    target: PaperTarget,
    scale: str,
    found: dict[str, dict[str, Array]],
    made: Provenance,
) -> None:
    seconds = sum(float(part.pop(_SECONDS)) for part in found.values())
    finding = target.finding(found)
    reproduced = ReproducedTarget.from_finding(target, scale, finding, seconds)
    save(finding.picture, place / reproduced.picture, overwrite=True)
    record = reproduced.record() | {"curves": finding.curves, **made.record()}
    write_json(place / f"{target.name}.json", record, overwrite=True)
