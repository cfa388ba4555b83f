"""How far reading a Measurement Set slows gridding down: 64 channels, two correlations, SKA-Mid AA2.

    python benchmarks/reading.py

One image from visibilities in memory, and the same from the set, turn about in one run; the floor beside them is the
time that the bytes of the set take to be read and nothing else. Files come from the page cache.
"""

import argparse
import math
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.diagnostics.psf import point_spread_function
from uvshear.execution import in_threads
from uvshear.galaxy import Exponential, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.imaging import ImageGrid
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.simulation.observation import SimulatedObservation

CENTRE = PhaseCentre(0.3, math.radians(-30))


def main() -> None:
    """Write a set, time, print the medians."""
    arguments = parse()
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "field.ms"
        write_measurement_set(path, observed(arguments.samples, arguments.channels))
        measure(path, arguments)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--samples", type=int, default=32, help="integrations")
    parser.add_argument("--channels", type=int, default=64)
    parser.add_argument("--size", type=int, default=512, help="pixels of an image's side")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    return parser.parse_args()


def observed(samples: int, channels: int) -> SimulatedObservation:
    track = Track.from_clock(CENTRE, ((-7200.0, 7200.0),), 14400.0 / samples * (1 - 1e-9))
    nobody = Galaxies(
        l=np.zeros(1),
        m=np.zeros(1),
        flux=np.zeros(1),
        scale_length=np.full(1, ARCSEC),
        ellipticity=np.zeros(1, complex),
        spectral_index=np.zeros(1),
    )
    return SimulatedObservation(
        coverage=synthesise(load_layout("ska-mid-aa2"), track),
        channels=Channels.from_band(0.95e9, 1.19e9, channels),
        galaxies=nobody,
        profile=Exponential(),
        noise=ScaledNoise(1e-4),
        seed=1,
    )


def measure(path: Path, arguments: argparse.Namespace) -> None:
    observation = MeasurementSet(path)
    memory = VisibilitySet(observation.phase_centre, tuple(observation.chunks()))
    grid = ImageGrid(arguments.size, 0.3 * ARCSEC)
    ways: dict[str, Callable[[], object]] = {
        "gridding": lambda: point_spread_function(
            memory, grid, executor=in_threads(arguments.threads)
        ),
        "reading and gridding": lambda: point_spread_function(
            observation, grid, executor=in_threads(arguments.threads)
        ),
        "reading": lambda: sum(len(chunk) for chunk in observation.chunks()),
    }
    samples = sum(block.weights.size for block in memory.blocks)
    wall, cpu = {name: [] for name in ways}, {name: [] for name in ways}
    for _ in range(arguments.rounds):
        for name, way in ways.items():
            start = time.perf_counter(), time.process_time()
            way()
            wall[name].append(time.perf_counter() - start[0])
            cpu[name].append(time.process_time() - start[1])
    size = sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
    print(f"{samples / 1e6:.1f} million samples, {size / 1e9:.2f} GB on disk")
    for name in ways:
        print(
            f"{name:21} {np.median(wall[name]):6.2f} s wall, {np.median(cpu[name]):6.2f} s CPU,"
            f" {samples / np.median(wall[name]) / 1e6:5.1f} million samples a second"
        )
    ratio = np.array(wall["gridding"]) / wall["reading and gridding"]
    print(f"speed of both over that of gridding: {np.median(ratio):.2f}")


if __name__ == "__main__":
    main()
