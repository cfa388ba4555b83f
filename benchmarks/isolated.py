"""Slopes, errors and pulls of galaxies that are alone in the field, on SKA-Mid AA4.

Each galaxy is simulated by itself, anywhere within 0.7 deg of the phase centre, with its own noise, and measured
with the catalogue's true position and flux.

    python benchmarks/isolated.py --galaxies 256 --snr 2000
    python benchmarks/isolated.py --galaxies 400 --snr 30 100
    python benchmarks/isolated.py --galaxies 256 --snr 180 --facet cell-average --scale-lengths 38
"""

import argparse
import math

import numpy as np
import survey
from survey import FREQUENCY, PHASE_CENTRE

import uvshear
from uvshear.constants import MICROJANSKY
from uvshear.diagnostics.slope import fit_slopes
from uvshear.execution import in_processes
from uvshear.extraction.paper.cell_average import CellAverageFacets, PaperTable, ScaleLengths
from uvshear.extraction.paper.exact import ExactFacets
from uvshear.galaxy import Exponential, Galaxies
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.predict import predict_visibilities
from uvshear.simulation.sky_region import DiscField


def main() -> None:
    """Measure, and print one table."""
    arguments = parse()
    galaxies = draw(arguments.galaxies, arguments.seed)
    snr = np.geomspace(*arguments.snr[[0, -1]], arguments.galaxies)
    snr = np.random.default_rng(arguments.seed + 1).permutation(snr)
    extraction = uvshear.PaperExtraction(facet=facet_method(arguments), passes=arguments.passes)
    jobs = [
        (galaxies.select(np.array([i])), float(snr[i]), arguments.seed + 100 + i)
        for i in range(arguments.galaxies)
    ]
    setting = (arguments, uvshear.Method(extraction=extraction))
    rows = list(in_processes(arguments.processes).distribute(measure_one, setting, jobs))
    report(galaxies.ellipticity, rows)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--galaxies", type=int, default=256)
    parser.add_argument("--snr", type=float, nargs="+", default=[2000.0], help="one, or a range")
    parser.add_argument(
        "--facet", choices=["exact", "cell-average", "paper-table"], default="exact"
    )
    parser.add_argument("--scale-lengths", type=float, help="field of view of a facet")
    parser.add_argument("--passes", type=int, default=2)
    parser.add_argument("--integration-s", type=float, default=2000.0)
    parser.add_argument("--without-w", action="store_true", help="all baselines in one plane")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=2)
    arguments = parser.parse_args()
    arguments.snr = np.array(arguments.snr)
    return arguments


def facet_method(arguments: argparse.Namespace):
    if arguments.facet == "paper-table":
        return CellAverageFacets(PaperTable())
    size = arguments.scale_lengths
    if arguments.facet == "cell-average":
        return CellAverageFacets(ScaleLengths(size or 38.0))
    return ExactFacets() if size is None else ExactFacets(scale_lengths=size)


def draw(number: int, seed: int) -> Galaxies:
    return survey.draw(DiscField(math.radians(0.7)), number, np.random.default_rng(seed))


def measure_one(
    setting: tuple, job: tuple
) -> tuple[complex, float, float, float, float, str, float]:
    (arguments, method), (galaxy, snr, seed) = setting, job
    uvw = survey.coverage(arguments.integration_s).uvw
    if arguments.without_w:
        uvw[:, 2] = 0
    vis = predict_visibilities(galaxy, uvw, FREQUENCY, Exponential())
    sigma = math.sqrt(float(np.sum(np.abs(vis) ** 2))) / snr
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=vis.shape) + 1j * rng.normal(size=vis.shape)
    weights = np.full(vis.shape, sigma**-2)
    block = Visibilities(uvw, FREQUENCY, vis + sigma * noise, weights)
    observation = VisibilitySet(PHASE_CENTRE, (block,))
    shape = uvshear.measure(
        observation,
        catalogue_from_galaxies(galaxy, PHASE_CENTRE),
        method=method,
        resources=uvshear.Resources(executor=uvshear.Serial()),
    ).shapes[0]
    e = complex(shape["e1"], shape["e2"])
    return (
        e,
        shape["e1_err"],
        shape["e2_err"],
        shape["e_sigma"],
        shape["snr"],
        str(shape["flag"]),
        shape["flux_fit"] * MICROJANSKY / float(galaxy.flux[0]),
    )


def report(true: np.ndarray, rows: list[tuple]) -> None:
    measured = np.array([row[0] for row in rows])
    errors = np.array([row[1:3] for row in rows]).T
    flags, counts = np.unique([row[5] for row in rows], return_counts=True)
    print(
        f"{len(rows)} galaxies, SNR {min(r[4] for r in rows):.0f}-{max(r[4] for r in rows):.0f};",
        end=" ",
    )
    print(", ".join(f"{n} {flag}" for flag, n in zip(flags, counts, strict=True)))
    print(
        "component  slope             unweighted        rms     rms, |e|>0.5  pull mean       pull width"
    )
    parts = zip(("e1", "e2"), (np.real, np.imag), errors, strict=True)
    for name, part, error in parts:
        x, y = part(true), part(measured)
        slopes = fit_slopes(x, y, error)
        weighted, plain = slopes.population, slopes.unweighted
        difference, large = y - x, np.abs(true) > 0.5
        pull = difference / error
        print(
            f"{name}         {weighted.value:.4f} +- {weighted.error:.4f}  {plain.value:.4f} +- {plain.error:.4f}"
            f"  {rms(difference):.5f} {rms(difference[large]):.5f}      "
            f"{pull.mean():+.3f} +- {1 / math.sqrt(len(pull)):.3f} "
            f"{pull.std():.3f} +- {1 / math.sqrt(2 * len(pull)):.3f}"
        )
    flux = np.array([row[6] for row in rows])
    print(
        f"flux, fitted over true: {np.nanmedian(flux):.4f}; median e_sigma {np.median([r[3] for r in rows]):.4f}"
    )


def rms(values: np.ndarray) -> float:
    return math.sqrt(float(np.mean(values**2)))


if __name__ == "__main__":
    main()
