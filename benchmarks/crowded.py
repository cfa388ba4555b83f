"""A crowded field against the same galaxies, with the same noise, alone in the field; SKA-Mid AA4, 8 h.

    python benchmarks/crowded.py --field-arcmin 38 --density 2.8
    python benchmarks/crowded.py --field-arcmin 20 --density 8 --extraction paper

The isolated fit of a galaxy takes the residual facet of the noise alone and puts the galaxy's true model on it.
"""

import argparse
import json
import math
import resource
import time
from dataclasses import replace

import numpy as np
from astropy.table import Table

import uvshear
from uvshear.concurrency import in_order
from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.extraction.beams import gather_beams
from uvshear.extraction.plan import SMALL, Wanted, plan_visit
from uvshear.extraction.residual import Gridding, ModelledSky, gather_residuals
from uvshear.fit.measurement import GalaxyFit
from uvshear.fit.prior import ShapePrior
from uvshear.fit.shape import measure_shape
from uvshear.fit.template import Template
from uvshear.galaxy import (
    DiscEllipticityPrior,
    Exponential,
    Galaxies,
    PowerLawFlux,
    SizeFluxRelation,
)
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.measurement import ConvergedExtraction, MeasurementOptions, PaperExtraction
from uvshear.predict import predict_visibilities
from uvshear.predict.spectrum import SpectralExpansion
from uvshear.shear.slope import fit_slope
from uvshear.simulation.field import SquareField
from uvshear.simulation.population import Population, draw_population

FREQUENCY = np.array([1.07e9])
PHASE_CENTRE = PhaseCentre(0.3, math.radians(-30))
BRIGHT = 25 * MICROJANSKY


def main() -> None:
    """Simulate, measure both ways, print."""
    arguments = parse()
    galaxies, observation, noise = simulate(arguments)
    print(f"{len(galaxies)} galaxies, {sum(map(len, observation.blocks))} rows", flush=True)
    extraction = ConvergedExtraction() if arguments.extraction == "converged" else PaperExtraction()
    options = MeasurementOptions(extraction=extraction, threads=arguments.threads)
    catalogue = catalogue_from_galaxies(galaxies, PHASE_CENTRE)
    wall, cpu = time.perf_counter(), time.process_time()
    shapes = uvshear.measure(observation, catalogue, options)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"{arguments.extraction}: {wall:.1f} s wall, {cpu:.1f} s CPU, {memory:.2f} GB at most")
    print(json.loads(shapes.meta["extract"]), flush=True)
    alone = None if arguments.without_isolated else isolated(galaxies, noise, arguments.threads)
    report(galaxies, shapes, alone)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--field-arcmin", type=float, default=38.0)
    parser.add_argument("--density", type=float, default=2.8, help="galaxies a square arcminute")
    parser.add_argument("--integration-s", type=float, default=900.0)
    parser.add_argument("--extraction", choices=["converged", "paper"], default="converged")
    parser.add_argument("--without-isolated", action="store_true")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--threads", type=int, default=2)
    return parser.parse_args()


def simulate(arguments: argparse.Namespace) -> tuple[Galaxies, VisibilitySet, VisibilitySet]:
    """Field with noise, and the noise alone: 10 uJy at an SNR of 10."""
    rng = np.random.default_rng(arguments.seed)
    population = Population(
        PowerLawFlux(minimum=10 * MICROJANSKY, maximum=200 * MICROJANSKY),
        SizeFluxRelation(),
        DiscEllipticityPrior(),
    )
    number = round(arguments.density * arguments.field_arcmin**2)
    field = SquareField(math.radians(arguments.field_arcmin / 60))
    galaxies = draw_population(population, field, number=number, rng=rng)
    track = Track.from_clock(PHASE_CENTRE, ((-14400.0, 14400.0),), arguments.integration_s)
    uvw = synthesise(load_layout("ska-mid-aa4"), track).uvw
    flux = np.array([10 * MICROJANSKY])
    median = Galaxies(
        l=np.zeros(1),
        m=np.zeros(1),
        flux=flux,
        scale_length=SizeFluxRelation().median(flux),
        ellipticity=np.zeros(1, complex),
        spectral_index=np.array([-0.7]),
    )
    power = np.sum(np.abs(predict_visibilities(median, uvw, FREQUENCY, Exponential(), 2)) ** 2)
    sigma = math.sqrt(float(power)) / 10
    vis = predict_visibilities(galaxies, uvw, FREQUENCY, Exponential(), arguments.threads)
    noise = sigma * (rng.normal(size=vis.shape) + 1j * rng.normal(size=vis.shape))
    weights = np.full(vis.shape, sigma**-2, np.float32)

    def seen(data: np.ndarray) -> VisibilitySet:
        block = Visibilities(uvw, FREQUENCY, data.astype(np.complex64), weights)
        return VisibilitySet(PHASE_CENTRE, (block,))

    return galaxies, seen(vis + noise), seen(noise)


def isolated(galaxies: Galaxies, noise: VisibilitySet, threads: int) -> Table:
    """Shapes of the galaxies, each alone with the noise."""
    relation, profile = SizeFluxRelation(), Exponential()
    size = relation.prior(galaxies.flux)
    median = np.exp(size.log_median)
    uv_max = SMALL / (median * np.exp(-2 * size.sigma))
    long_axis = galaxies.scale_length / (1 - np.abs(galaxies.ellipticity))
    width = np.maximum(45 * median, 12 * long_axis)
    pixel = 1 / (2.4 * float(uv_max.max()))
    lm = np.column_stack([galaxies.l, galaxies.m])
    plan = plan_visit(
        Wanted(galaxies.l, galaxies.m, np.minimum(width, 560 * pixel), uv_max),
        0.0,
        float(uv_max.max()),
    )
    nothing = replace(galaxies, flux=np.zeros(len(galaxies)))
    gridding = Gridding(threads=threads)
    empty = SpectralExpansion.of(nothing, FREQUENCY[0], FREQUENCY[0])
    spectrum = SpectralExpansion.of(galaxies, FREQUENCY[0], FREQUENCY[0])
    beams = gather_beams(noise, lm, (0.0, float(uv_max.max())), plan.pixel, spectrum, gridding)
    half = np.full(len(galaxies), 20 * ARCSEC)
    residuals = gather_residuals(noise, plan, ModelledSky(nothing, half, empty, profile), gridding)

    def measure(k: int):
        cutout = plan.cutouts[k]
        power = beams.power(k, cutout)
        true = GalaxyFit(
            flux=float(spectrum.fluxes[0, k]),
            offset=np.zeros(2),
            ellipticity=complex(galaxies.ellipticity[k]),
            scale_length=float(galaxies.scale_length[k]),
            snr=1.0,
        )
        facet = Facet(
            cutout.uv, residuals[k] + power * Template(cutout.uv, profile).model(true), power
        )
        return measure_shape(facet, ShapePrior(size.log_median[k], size.sigma[k]), profile)

    results = list(in_order(measure, range(len(galaxies)), threads))
    return Table(
        {
            "e1": [r.ellipticity[0] for r in results],
            "e2": [r.ellipticity[1] for r in results],
            "e1_err": [math.sqrt(r.covariance[0, 0]) for r in results],
            "e2_err": [math.sqrt(r.covariance[1, 1]) for r in results],
            "flag": [r.flag.word for r in results],
        }
    )


def report(galaxies: Galaxies, shapes: Table, alone: Table | None) -> None:
    print(
        "galaxies   which      n     scatter  slope e1           slope e2           pulls  >4 sigma"
    )
    both = np.array(shapes["flag"]) == "ok"
    if alone is not None:
        both &= np.array(alone["flag"]) == "ok"
    for name, chosen in (("all", both), ("> 25 uJy", both & (galaxies.flux > BRIGHT))):
        for which, table in (("crowded", shapes), ("alone", alone)):
            if table is not None:
                print(f"{name:10s} {which:8s} {line(galaxies, table, chosen)}")
    flags, counts = np.unique(np.array(shapes["flag"]), return_counts=True)
    print(", ".join(f"{n} {flag}" for flag, n in zip(flags, counts, strict=True)))


def line(galaxies: Galaxies, table: Table, chosen: np.ndarray) -> str:
    true = galaxies.ellipticity[chosen]
    difference, pulls, slopes = [], [], []
    for name, part in (("e1", true.real), ("e2", true.imag)):
        measured, error = np.array(table[name])[chosen], np.array(table[f"{name}_err"])[chosen]
        difference.append(measured - part)
        pulls.append((measured - part) / error)
        slopes.append(fit_slope(part, measured, error))
    pull = np.concatenate(pulls)
    scatter = math.sqrt(float(np.mean(np.concatenate(difference) ** 2)))
    text = "  ".join(f"{slope.value:.4f} +- {slope.error:.4f}" for slope in slopes)
    return (
        f"{len(true):5d}  {scatter:.4f}   {text}  {pull.std():.3f}"
        f"  {100 * np.mean(np.abs(pull) > 4):.2f} %"
    )


if __name__ == "__main__":
    main()
