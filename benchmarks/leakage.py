"""Additive bias against the beam's ellipticity, away from the zenith, and against the size at one SNR.

    python benchmarks/leakage.py --estimator mean --galaxies 1000 --table leakage.ecsv
    python benchmarks/leakage.py --estimator bayesian --galaxies 4500 --zenith-deg 60 --size-arcsec

SKA-Mid AA4, 8 h, no limit of the elevation. Each galaxy is seen eight times: with e and -e, noise and its
opposite, and all of it turned by a right angle, so that only what the beam's own direction does is left.
``joined_seeds.py`` joins the seeds of a table, ``leakage_figure.py`` draws that.
"""

import argparse
import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from astropy.table import Table, vstack

import uvshear
from uvshear.bias.isolated import Experiment, estimate_isolated_bias
from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.execution import in_processes, in_threads
from uvshear.galaxy import Exponential, PowerLawFlux, SizeFluxRelation
from uvshear.interferometer.psf_shape import measure_psf
from uvshear.shapes.prior import ShapePrior
from uvshear.simulation.population import Population

LATITUDE = -30.7
ZENITH_DISTANCES = (0.0, 20.0, 40.0, 60.0)
SIZES = (0.6, 1.0, 1.6, 2.5)
SNR = 20.0


def main() -> None:
    """Measure the bias without shear, print, add to the table."""
    arguments = parse()
    rows = []
    for zenith in arguments.zenith_deg:
        experiment = isolated(zenith, arguments.seed)
        rows += measured(arguments, experiment, {"zenith_deg": zenith, "size_arcsec": 0.0})
    for size in arguments.size_arcsec:
        experiment = of_size(isolated(40.0, arguments.seed), size)
        rows += measured(arguments, experiment, {"zenith_deg": 40.0, "size_arcsec": size})
    table = Table(rows)
    table.pprint_all()
    if arguments.table:
        known = [Table.read(arguments.table)] if arguments.table.exists() else []
        vstack([*known, table]).write(arguments.table, overwrite=True)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--estimator", choices=["bayesian", "mean", "moments"], default="moments")
    parser.add_argument("--galaxies", type=int, default=1000)
    parser.add_argument("--zenith-deg", type=float, nargs="*", default=ZENITH_DISTANCES)
    parser.add_argument("--size-arcsec", type=float, nargs="*", default=SIZES)
    parser.add_argument("--table", type=Path, help="ECSV to add the figures to")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    return parser.parse_args()


def isolated(zenith_deg: float, seed: int) -> Experiment:
    """Galaxies alone in the beam of a track about transit, North of the zenith by an angle."""
    centre = uvshear.PhaseCentre(0.0, math.radians(LATITUDE + zenith_deg))
    track = uvshear.Track.from_clock(centre, ((-14400.0, 14400.0),), 300.0)
    channels = uvshear.Channels.from_band(950e6, 1190e6, 1)
    plan = uvshear.ObservingPlan(uvshear.load_layout("ska-mid-aa4"), track, channels)
    return uvshear.Survey(plan, snr_min=10.0).isolated((0j,), seed, in_threads(2))


def of_size(experiment: Experiment, size_arcsec: float) -> Experiment:
    """Galaxies of one size and flux, with noise that gives them a signal-to-noise ratio of ``SNR``."""
    flux = PowerLawFlux(minimum=20 * MICROJANSKY, maximum=20.002 * MICROJANSKY)
    relation = SizeFluxRelation(intercept=math.log(size_arcsec), slope=0.0)
    prior = ShapePrior(math.log(size_arcsec * ARCSEC), relation.sigma)
    simulator = experiment.beam.simulator(prior.log_scale_length, prior.log_scale_length_sigma)
    snr = flux.minimum * simulator.snr_of_jansky(prior, Exponential())
    quieter = experiment.beam.image * (SNR / snr) ** 2
    beam = replace(experiment.beam, image=quieter, _simulators={})
    population = Population(flux=flux, size=relation)
    return replace(experiment, beam=beam, population=population, size=relation, snr_min=0.0)


def estimator_of(name: str, experiment: Experiment) -> uvshear.Estimator:
    """Return the estimator of a name; the Bayesian one knows the population that is drawn from."""
    if name == "bayesian":
        drawn = experiment.population
        return uvshear.Bayesian(population=uvshear.UnlensedPopulation(drawn.flux, drawn.size))
    return uvshear.Mean() if name == "mean" else uvshear.Moments()


def measured(arguments: argparse.Namespace, experiment: Experiment, about: dict) -> list[dict]:
    """Return one row for each bin of flux."""
    start = time.perf_counter()
    estimator = estimator_of(arguments.estimator, experiment)
    executor = in_processes(arguments.threads)
    bias = estimate_isolated_bias(experiment, estimator, arguments.galaxies, executor)
    psf = measure_psf(experiment.beam.image, experiment.beam.pixel)
    shape = {"psf_e1": psf.ellipticity.real, "psf_e2": psf.ellipticity.imag}
    print(f"{about}: {bias}, {time.perf_counter() - start:.0f} s", flush=True)
    first = {"estimator": arguments.estimator, "seed": arguments.seed, **about, **shape}
    return [{**first, "flux": part.name, **part.record()} for part in (bias, *bias.bins)]


if __name__ == "__main__":
    np.set_printoptions(precision=2)
    main()
