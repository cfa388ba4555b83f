"""Recordings of what long work reports about its progress, on which ``tests/progress/test_time_left.py`` replays it.

    python benchmarks/progress_recordings.py --folder FOLDER [--cpu-time] [NAME ...]

writes ``tests/progress/recordings/NAME.json`` for each of the named works, or for all of them: how long the work took,
and every report with its time [s]. Of the reports within a stage, the first two are kept, and those that are a
hundredth of the run apart.
The fields are simulated in FOLDER once. The machine should have nothing else to do; if it has, --cpu-time counts the
CPU time of simulations by one worker, which compute in this process alone and one step after the other.
"""

import argparse
import hashlib
import json
import shlex
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import uvshear
from uvshear.cli.application import run
from uvshear.progress import Observer, Stage

PARTS = 100
"""Number of parts of a run of which each has a report at most, besides the beginnings and the ends of the stages."""

FIRST = 2
"""Number of the first reports of a stage, from which its rate is known."""

RECORDINGS = Path(__file__).parents[1] / "tests" / "progress" / "recordings"

Event = list[Any]


Work: TypeAlias = Callable[[Observer], object]
"""Long work that reports to an observer."""


class Recorder(Observer):
    """Writes down every report with its time.

    Parameters
    ----------
    clock
        Function that returns the time [s].
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._start = clock()
        self.events: list[Event] = []

    @property
    def elapsed(self) -> float:
        """Time since the beginning [s]."""
        return self._clock() - self._start

    def begin(self, stage: Stage, *then: Stage) -> None:
        """Write down that a stage begins."""
        self._write("begin", [_values(each) for each in (stage, *then)])

    def advance(self, done: float, expected: float) -> None:
        """Write down how far the stage is."""
        self._write("advance", [round(done, 1), round(expected, 1)])

    def foresee(self, *then: Stage) -> None:
        """Write down which stages are expected from now on."""
        self._write("foresee", [_values(each) for each in then])

    def note(self, facts: Mapping[str, object]) -> None:
        """Write down how much a cycle has changed the sky."""
        if "change_rms" in facts:
            self._write("note", [facts["change_rms"]])

    def finish(self) -> None:
        """Write down that the last stage has ended."""
        self._write("finish", [])

    def _write(self, what: str, values: list[Any]) -> None:
        self.events.append([round(self.elapsed, 3), what, values])


def _values(stage: Stage) -> list[Any]:
    numbers = [float(f"{each:.4g}") for each in (stage.cost, stage.amount, stage.pace)]
    return [stage.name, *numbers[:2], stage.unit, stage.kind, numbers[2]]


def thinned(events: list[Event], total: float) -> list[Event]:
    """Leave out reports within a stage that follow others closely, except the first two and the last of each stage."""
    kept: list[Event] = []
    last, of_stage = 0.0, 0
    for event, following in zip(events, [*events[1:], [total, "finish", []]], strict=True):
        of_stage = 0 if event[1] == "begin" else of_stage + 1
        is_inside = event[1] == following[1] == "advance" and of_stage > FIRST
        # Results of a task come together, and the last of them tells most.
        if is_inside and (event[0] < last + total / PARTS or event[0] == following[0]):
            continue
        kept.append(event)
        last = event[0]
    return kept


@dataclass(frozen=True)
class Field:
    """A simulated field, as options of ``uvshear catalogue`` and ``uvshear simulate``."""

    sky: str
    telescope: str

    def make(self, folder: Path) -> tuple[Path, Path]:
        """Return the paths of its observation and of its catalogue."""
        name = hashlib.sha256(repr(self).encode()).hexdigest()[:12]
        catalogue, observation = folder / f"{name}.fits", folder / f"{name}.ms"
        if not observation.exists():
            commands = (
                f"catalogue {self.sky} --seed 1 --overwrite -o {catalogue}",
                f"simulate {self.telescope} --catalogue {catalogue} --seed 1 -o {observation}",
            )
            for command in commands:
                if run(shlex.split(command)):
                    raise SystemExit(command)
        return observation, catalogue


SKA = "--layout ska-mid-aa4 --declination-deg -30 --band-mhz 950 1190 --snr-at 10 10"
SMALL = Field(
    "--field-arcmin 6 --density 2.8 --flux-ujy 10 200",
    f"{SKA} --hours 8 --integration-s 900 --channels 1",
)
TWELVE = Field(
    "--field-arcmin 12 --density 2.8 --flux-ujy 10 200",
    f"{SKA} --hours 8 --integration-s 900 --channels 1",
)
SHORT = Field(
    "--field-arcmin 12 --density 2.8 --flux-ujy 10 200",
    f"{SKA} --hour-angles -0.1 0.1 --integration-s 60 --channels 2",
)
SMEARED = Field(
    "--field-arcmin 15 --density 0.4 --flux-ujy 10 200",
    f"{SKA} --hours 2 --integration-s 240 --channels 2 --smearing",
)
MEERKAT = Field(
    "--field-arcmin 30 --density 0.4 --flux-ujy 20 200",
    "--layout meerkat --declination-deg -30 --band-mhz 950 1190 --snr-at 10 10 --hours 8"
    " --integration-s 120 --channels 4",
)
VLA = Field(
    "--field-arcmin 15 --density 1.5 --flux-ujy 10 200",
    "--layout vla-a --declination-deg 30 --band-mhz 1200 1800 --snr-at 10 10 --hours 6"
    " --integration-s 60 --channels 8",
)
MANY_SAMPLES = Field(
    "--field-arcmin 30 --disc --count 300 --ring 1 --flux-ujy 100 2000",
    "--layout meerkat --declination-deg -30 --band-mhz 856 1712 --snr-at 300 30 --smearing"
    " --hour-angles -4.0 -3.2 --integration-s 8 --channels 128",
)
DEGREE = Field(
    "--field-arcmin 60 --count 10080",
    f"{SKA} --hours 8 --integration-s 60 --channels 1",
)


def measuring(field: Field, workers: int, keep: str = "", **options: Any) -> Callable[[Path], Work]:
    """Return the preparation of the measurement of a field."""

    def prepare(folder: Path) -> Work:
        path, catalogue = field.make(folder)
        observation = uvshear.open_observation(path)
        resources = uvshear.Resources(uvshear.Copies(workers))
        return lambda progress: uvshear.measure(
            observation,
            catalogue,
            keep=keep or (),
            resources=resources,
            progress=progress,
            **options,
        )

    return prepare


@dataclass(frozen=True)
class Simulation:
    """A simulated observation by SKA-Mid.

    Parameters
    ----------
    hours
        Length of the track.
    integration
        Integration time [s].
    channels
        Number of channels.
    is_averaged
        Whether samples are averages over channels and integrations.
    """

    hours: float
    integration: float
    channels: int
    is_averaged: bool = False

    @property
    def plan(self) -> uvshear.ObservingPlan:
        """The array, the track and the channels."""
        half = 1800 * self.hours
        centre = uvshear.PhaseCentre(0.0, -0.5)
        return uvshear.ObservingPlan(
            uvshear.load_layout("ska-mid-aa4"),
            uvshear.Track.from_clock(centre, ((-half, half),), self.integration),
            uvshear.Channels.from_band(0.95e9, 1.19e9, self.channels),
            is_averaged=self.is_averaged,
        )


def simulating(field: Field, simulation: Simulation, workers: int) -> Callable[[Path], Work]:
    """Return the preparation of the simulation of a field."""

    def prepare(folder: Path) -> Work:
        _, catalogue = field.make(folder)
        executor = uvshear.Threads(workers) if workers > 1 else uvshear.Serial()
        observation = uvshear.simulate(catalogue, simulation.plan, executor=executor)
        return lambda progress: uvshear.write_measurement_set(
            folder / "written.ms",
            observation,
            overwrite=True,
            executor=executor,
            progress=progress,
        )

    return prepare


def biased(workers: int, estimator: str, **options: Any) -> Callable[[Path], Work]:
    """Return the preparation of an estimate of the bias."""

    def prepare(_: Path) -> Work:
        resources = uvshear.Resources(uvshear.Copies(workers))
        return lambda progress: uvshear.estimate_bias(
            estimator, shear=0.03, resources=resources, progress=progress, **options
        )

    return prepare


def averaging(field: Field, workers: int) -> Callable[[Path], Work]:
    """Return the preparation of averages."""

    def prepare(folder: Path) -> Work:
        path, _ = field.make(folder)
        return lambda progress: uvshear.average(
            path,
            folder / "averages.ms",
            field_arcmin=30.0,
            resources=uvshear.Resources(uvshear.Threads(workers)),
            overwrite=True,
            progress=progress,
        )

    return prepare


def shearing(field: Field, estimator: str) -> Callable[[Path], Work]:
    """Return the preparation of an estimate of the shear of a field."""

    def prepare(folder: Path) -> Work:
        path, catalogue = field.make(folder)
        kept = uvshear.measure(path, catalogue, keep=estimator)
        return lambda progress: uvshear.estimate_shear(kept, estimator, progress=progress)

    return prepare


WORKS: dict[str, Callable[[Path], Work]] = {
    "small-1": measuring(SMALL, 1),
    "small-2": measuring(SMALL, 2),
    "twelve-1": measuring(TWELVE, 1),
    "twelve-2": measuring(TWELVE, 2),
    "twelve-moments-1": measuring(TWELVE, 1, "moments"),
    "twelve-moments-2": measuring(TWELVE, 2, "moments"),
    "twelve-all-2": measuring(TWELVE, 2, "moments,bayesian,metacal"),
    "short-2": measuring(SHORT, 2),
    "smeared-2": measuring(SMEARED, 2),
    "meerkat-1": measuring(MEERKAT, 1),
    "meerkat-2": measuring(MEERKAT, 2, "moments"),
    "vla-2": measuring(VLA, 2),
    "paper-2": measuring(SMALL, 2, method=uvshear.Method(extraction=uvshear.PaperExtraction())),
    "degree-2": measuring(DEGREE, 2),
    "simulate-1": simulating(TWELVE, Simulation(8, 30, 1), 1),
    "simulate-smeared-1": simulating(TWELVE, Simulation(1, 60, 2, is_averaged=True), 1),
    "simulate-channels-1": simulating(TWELVE, Simulation(1, 60, 32), 1),
    "bias-moments-2": biased(2, "moments", galaxies=20_000),
    "bias-bayesian-1": biased(1, "bayesian", galaxies=200),
    "bias-crowd-2": biased(2, "moments", galaxies=100, density=2.8),
    "average-2": averaging(MANY_SAMPLES, 2),
    "shear-bayesian": shearing(TWELVE, "bayesian"),
}
"""Preparations of long works; the number is that of the workers."""


def main() -> None:
    """Record the works."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(WORKS))
    parser.add_argument("--folder", type=Path, required=True, help="folder for the fields")
    parser.add_argument("--cpu-time", action="store_true", help="count the CPU time")
    given = parser.parse_args()
    for name in given.names or WORKS:
        clock = time.process_time if given.cpu_time else time.perf_counter
        record(name, WORKS[name](given.folder), clock)


def record(name: str, work: Work, clock: Callable[[], float] = time.perf_counter) -> None:
    """Do some work and record it."""
    recorder = Recorder(clock)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        work(recorder)
    total = recorder.elapsed
    lines = [json.dumps(event, separators=(",", ":")) for event in thinned(recorder.events, total)]
    text = f'{{"total": {total:.3f},\n "events": [\n  {f",{chr(10)}  ".join(lines)}]}}\n'
    RECORDINGS.mkdir(parents=True, exist_ok=True)
    (RECORDINGS / f"{name}.json").write_text(text, encoding="utf-8")
    print(f"{name}: {total:.1f} s, {len(recorder.events)} reports, {len(text)} bytes")


if __name__ == "__main__":
    main()
