"""What the extraction costs, on SKA-Mid AA4 over 8 h: growth with rows and with sources, and a profile.

    python benchmarks/extraction_cost.py --grid docs/pictures/cost.png
    python benchmarks/extraction_cost.py --against-gridder
    python benchmarks/extraction_cost.py --profile

``--against-gridder``: CPU time of 0.93 million rows and 101 sources over that of one w-gridder pass over the same
field (2400^2 pixels of 0.15 arcsec, epsilon 1e-4), both in this process, compilation aside.
"""

import argparse
import cProfile
import math
import pstats
import time
from pathlib import Path

import survey
from astropy.table import Table

import uvshear
from uvshear.execution import in_copies, in_threads
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.plot.figure import BLUE, GREY, ORANGE, new_figure, save


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--grid", type=Path, metavar="PICTURE")
    parser.add_argument("--against-gridder", action="store_true")
    parser.add_argument("--profile", action="store_true")
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    measure(field(3.0, 1800.0), arguments.threads)  # compiles
    if arguments.against_gridder:
        against_gridder(arguments.threads)
    if arguments.profile:
        profile()
    if arguments.grid:
        draw_growth(growth(arguments.threads), arguments.grid)


def growth(threads: int) -> Table:
    """Cost for more and more rows, then for more and more sources."""
    rows = []
    print("series   rows      sources  wall [s]  CPU [s]  cycles")
    for series, arcmin, integration in (
        *(("rows", 6.0, seconds) for seconds in (1800.0, 600.0, 200.0, 60.0)),
        *(("sources", arcmin, 900.0) for arcmin in (3.0, 6.0, 12.0, 24.0)),
    ):
        world = field(arcmin, integration)
        wall, cpu, cycles = measure(world, threads)
        number = sum(map(len, world[1].blocks))
        rows.append((series, number, len(world[0]), wall, cpu, cycles))
        print(
            f"{series:8s} {number:8d}  {len(world[0]):7d}  {wall:8.1f}  {cpu:7.1f}  {cycles:6d}",
            flush=True,
        )
    return Table(rows=rows, names=("series", "rows", "sources", "wall", "cpu", "cycles"))


def draw_growth(table: Table, picture: Path) -> None:
    figure, axes = new_figure(2, 9.5, 4.2)
    for ax, series in zip(axes, ("rows", "sources"), strict=True):
        part = table[table["series"] == series]
        other = "sources" if series == "rows" else "rows"
        for name, colour, marker, label in (
            ("cpu", BLUE, "o", "CPU time"),
            ("wall", ORANGE, "s", "wall time, two cores"),
        ):
            ax.loglog(part[series], part[name], marker + "-", color=colour, label=label)
        slope = part["cpu"][-1] / part[series][-1]
        ax.loglog(part[series], slope * part[series], ":", color=GREY, label="proportional")
        ax.set(xlabel=f"number of {series}", ylabel="time [s]")
        ax.set_title(f"{part[other][0]} {other}", fontsize="medium")
        ax.legend(frameon=False)
    save(figure, picture, overwrite=True)


def field(arcmin: float, integration: float):
    galaxies, observation, _ = survey.simulate(
        arcmin, 2.8, integration, seed=7, executor=in_threads(2)
    )
    return galaxies, observation


def measure(world, threads: int) -> tuple[float, float, int]:
    galaxies, observation = world
    catalogue = catalogue_from_galaxies(galaxies, survey.PHASE_CENTRE)
    wall, cpu = time.perf_counter(), survey.cpu_seconds()
    resources = uvshear.Resources(executor=in_copies(threads))
    measurement = uvshear.measure(observation, catalogue, resources=resources)
    wall, cpu = time.perf_counter() - wall, survey.cpu_seconds() - cpu
    return wall, cpu, int(measurement.record["major_cycles"])


def against_gridder(threads: int) -> None:
    world = field(6.0, 600.0)
    gridder = survey.gridder_seconds()
    _, extraction, cycles = measure(world, threads)
    rows = sum(map(len, world[1].blocks))
    print(
        f"{rows} rows, {len(world[0])} sources: {extraction:.1f} s CPU in {cycles} major cycles; "
        f"one pass of the gridder {gridder:.2f} s; ratio {extraction / gridder:.1f}"
    )


def profile() -> None:
    world = field(12.0, 600.0)
    profiler = cProfile.Profile()
    profiler.enable()
    measure(world, 1)
    profiler.disable()
    stats = pstats.Stats(profiler)
    total = stats.total_tt
    print(f"12 arcmin, {len(world[0])} sources, one thread: {total:.1f} s")
    rows = sorted(stats.stats.items(), key=lambda item: -item[1][2])[:16]
    for (file, _, name), (_, calls, own, _, _) in rows:
        where = "/".join(file.split("/")[-2:]) if math.isfinite(own) else file
        print(f"{100 * own / total:5.1f} %  {calls:7d} calls  {where} {name}")


if __name__ == "__main__":
    main()
