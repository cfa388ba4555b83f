"""A crowded field compared with the same galaxies, with the same noise, alone in the field; SKA-Mid AA4, 8 h.

    python benchmarks/crowded.py --field-arcmin 60 --integration-s 60 --record crowded
    python benchmarks/crowded.py --field-arcmin 38 --density 2.8 --table density.ecsv
    python benchmarks/crowded.py --field-arcmin 20 --density 8 --extraction paper --table density.ecsv

The first is the paper's square degree: its record holds the slopes by the paper's definition and by others, the
fraction of flagged galaxies, time and memory. The isolated fit of a galaxy takes the residual facet of the noise alone,
with all baselines, and puts the galaxy's true model on it. ``--table`` adds rows to a table, which
``density_figure.py`` draws.
"""

import argparse
import math
import resource
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import survey
from astropy.table import Table, vstack
from record import RESULTS, write_record
from slopes import slope_figures

import uvshear
from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.diagnostics.slope import fit_slope, population_weights
from uvshear.execution import Executor, in_copies
from uvshear.extraction.converged.beams import BeamPlan, gather_beams
from uvshear.extraction.converged.major_cycle import gather_residuals
from uvshear.extraction.converged.plan import SMALL, FacetRequests, plan_major_cycle
from uvshear.galaxy import Exponential, Galaxies, SizeFluxRelation
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.pipeline.sample import FITTED
from uvshear.predict.gridded import Gridding, ModelledSky
from uvshear.predict.response import Response
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import measure_shape
from uvshear.shapes.template import Template

BRIGHT = 25 * MICROJANSKY


def main() -> None:
    """Simulate, measure both ways, print, write."""
    arguments = parse()
    executor = in_copies(arguments.threads)
    galaxies, observation, noise = survey.simulate(
        arguments.field_arcmin, arguments.density, arguments.integration_s, arguments.seed, executor
    )
    rows = sum(map(len, observation.blocks))
    print(f"{len(galaxies)} galaxies, {rows} rows", flush=True)
    is_converged = arguments.extraction == "converged"
    method = uvshear.Method(
        extraction=uvshear.ConvergedExtraction() if is_converged else uvshear.PaperExtraction()
    )
    catalogue = catalogue_from_galaxies(galaxies, survey.PHASE_CENTRE)
    gridder = survey.gridder_seconds()
    wall, cpu = time.perf_counter(), survey.cpu_seconds()
    measurement = uvshear.measure(
        observation, catalogue, method=method, resources=uvshear.Resources(executor=executor)
    )
    wall, cpu = time.perf_counter() - wall, survey.cpu_seconds() - cpu
    gridder = (gridder + survey.gridder_seconds()) / 2
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6  # of kilobytes
    print(f"{arguments.extraction}: {wall:.1f} s wall, {cpu:.1f} s CPU, {memory:.2f} GB at most")
    print(f"one pass of the gridder {gridder:.2f} s: {wall / gridder:.0f} of them")
    print(measurement.record, flush=True)
    shapes = measurement.shapes
    if arguments.shapes:
        shapes.write(arguments.shapes, overwrite=True)
    flags, counts = np.unique(np.array(shapes["flag"]), return_counts=True)
    print(", ".join(f"{n} {flag}" for flag, n in zip(flags, counts, strict=True)), flush=True)
    alone = None if arguments.without_isolated else isolated(galaxies, noise, executor)
    if arguments.record:
        flagged = int(np.sum(~np.isin(np.array(shapes["flag"]), FITTED)))
        found = {
            "galaxies": len(galaxies),
            "rows": rows,
            "flagged": flagged,
            "flagged_percent": 100 * flagged / len(galaxies),
            "wall_min": wall / 60,
            "cpu_s": cpu,
            "gridder_s": gridder,
            "wall_over_gridder": wall / gridder,
            "cpu_s_per_galaxy": cpu / len(galaxies),
            "memory_gb": memory,
            **slopes_of(galaxies, shapes),
        }
        if alone is not None:
            of_alone = slopes_of(galaxies, alone)
            found |= {f"alone_{name}": value for name, value in of_alone.items()}
        write_record(
            RESULTS / f"{arguments.record}.json",
            found,
            [arguments.seed],
            title=(
                f"{len(galaxies)} galaxies at {arguments.density:g} per square arcminute, {rows} rows of SKA-Mid AA4"
                f" in 8 h; {arguments.extraction} extraction, {arguments.threads} threads."
            ),
        )
    summary = summarise(galaxies, {arguments.extraction: shapes, "alone": alone})
    summary["density"] = arguments.density
    summary.pprint_all()
    if arguments.table:
        known = [Table.read(arguments.table)] if arguments.table.exists() else []
        vstack([*known, summary]).write(arguments.table, overwrite=True)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--field-arcmin", type=float, default=38.0)
    parser.add_argument("--density", type=float, default=2.8, help="galaxies a square arcminute")
    parser.add_argument("--integration-s", type=float, default=900.0)
    parser.add_argument("--extraction", choices=["converged", "paper"], default="converged")
    parser.add_argument("--without-isolated", action="store_true")
    parser.add_argument("--table", type=Path, help="ECSV to add the figures to")
    parser.add_argument("--record", help="name of a record to write to benchmarks/results")
    parser.add_argument("--shapes", type=Path, help="file for the shapes")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--threads", type=int, default=2)
    return parser.parse_args()


def isolated(galaxies: Galaxies, noise: VisibilitySet, executor: Executor) -> Table:
    """Shapes of the galaxies, each alone with the noise."""
    relation, profile = SizeFluxRelation(), Exponential()
    size = relation.prior(galaxies.flux)
    median = np.exp(size.log_median)
    uv_max = SMALL / (median * np.exp(-2 * size.sigma))
    long_axis = galaxies.scale_length / (1 - np.abs(galaxies.ellipticity))
    width = np.maximum(45 * median, 12 * long_axis)
    pixel = 1 / (2.4 * float(uv_max.max()))
    plan = plan_major_cycle(
        FacetRequests(galaxies.l, galaxies.m, np.minimum(width, 560 * pixel), uv_max),
        0.0,
        float(uv_max.max()),
    )
    nothing = replace(galaxies, flux=np.zeros(len(galaxies)))
    gridding = Gridding(executor=executor)
    response = Response.from_sky(galaxies)
    beam_plan = BeamPlan.around(galaxies, response, 0.0, float(uv_max.max()), plan.pixel)
    beams = gather_beams(noise, beam_plan, response, gridding)
    half = np.full(len(galaxies), 20 * ARCSEC)
    residuals = gather_residuals(
        noise, plan, ModelledSky(nothing, half, response, profile), gridding
    )

    def measure(k: int):
        cutout = plan.cutouts[k]
        power = beams.power(k, cutout)
        true = GalaxyFit(
            flux=float(galaxies.flux[k]),
            offset=np.zeros(2),
            ellipticity=complex(galaxies.ellipticity[k]),
            scale_length=float(galaxies.scale_length[k]),
            snr=1.0,
        )
        facet = Facet(
            cutout.uv, residuals[k] + power * Template(cutout.uv, profile).model(true), power
        )
        return measure_shape(facet, ShapePrior(size.log_median[k], size.sigma[k]), profile)

    results = list(executor.map(measure, range(len(galaxies))))
    return Table(
        {
            "e1": [r.ellipticity[0] for r in results],
            "e2": [r.ellipticity[1] for r in results],
            "e1_err": [math.sqrt(r.covariance[0, 0]) for r in results],
            "e2_err": [math.sqrt(r.covariance[1, 1]) for r in results],
            "flag": [r.flag.word for r in results],
        }
    )


def slopes_of(galaxies: Galaxies, table: Table) -> dict[str, float]:
    """Slopes of the galaxies whose fit succeeded, by every definition."""
    good = np.isin(np.array(table["flag"]), FITTED)
    columns = (np.array(table[name], float) for name in ("e1", "e2", "e1_err", "e2_err"))
    e1, e2, e1_err, e2_err = (column[good] for column in columns)
    return {"measured": int(good.sum())} | slope_figures(
        galaxies.ellipticity[good],
        e1 + 1j * e2,
        np.column_stack([e1_err, e2_err]),
        galaxies.flux[good] / MICROJANSKY,
    )


def summarise(galaxies: Galaxies, measured: dict[str, Table | None]) -> Table:
    """Scatter, slopes and pulls of the galaxies that every way has measured."""
    tables = {which: table for which, table in measured.items() if table is not None}
    both = np.all([np.isin(np.array(table["flag"]), FITTED) for table in tables.values()], axis=0)
    rows = [
        {"which": which, "flux": name, **figures(galaxies, table, chosen)}
        for name, chosen in (("all", both), ("> 25 uJy", both & (galaxies.flux > BRIGHT)))
        for which, table in tables.items()
    ]
    summary = Table(rows)
    for name in summary.colnames[3:]:
        summary[name].format = ".4f"
    return summary


def figures(galaxies: Galaxies, table: Table, chosen: np.ndarray) -> dict[str, float]:
    true = galaxies.ellipticity[chosen]
    difference, pulls, row = [], [], {"n": int(chosen.sum())}
    for name, part in (("e1", true.real), ("e2", true.imag)):
        measured, error = np.array(table[name])[chosen], np.array(table[f"{name}_err"])[chosen]
        difference.append(measured - part)
        pulls.append((measured - part) / error)
        slope = fit_slope(part, measured, error, population_weights)
        row |= {f"slope_{name}": slope.value, f"slope_{name}_err": slope.error}
    pull = np.concatenate(pulls)
    return row | {
        "scatter": math.sqrt(float(np.mean(np.concatenate(difference) ** 2))),
        "pull_width": float(pull.std()),
        "beyond_4_percent": 100 * float(np.mean(np.abs(pull) > 4)),
    }


if __name__ == "__main__":
    main()
