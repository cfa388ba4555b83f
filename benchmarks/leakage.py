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

from uvshear.bias.estimators import (
    BayesianEstimator,
    Estimator,
    MeanEstimator,
    MomentEstimator,
)
from uvshear.bias.experiment import Experiment, calibrate
from uvshear.bias.isolated import Beam
from uvshear.bias.survey import Survey
from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.estimators.evidence import UnlensedPopulation
from uvshear.execution import in_threads
from uvshear.galaxy import Exponential, PowerLawFlux, SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.psf_shape import measure_psf
from uvshear.interferometer.spectral_window import Channels
from uvshear.shapes.prior import ShapePrior
from uvshear.simulation.population import Population

LATITUDE = -30.7
ZENITH_DISTANCES = (0.0, 20.0, 40.0, 60.0)
SIZES = (0.6, 1.0, 1.6, 2.5)
SNR = 20.0


def main() -> None:
    """Calibrate without shear, print, add to the table."""
    arguments = parse()
    rows = []
    for zenith in arguments.zenith_deg:
        experiment = Experiment(beam(zenith), (0j,), snr_min=10.0, seed=arguments.seed)
        rows += measured(arguments, experiment, {"zenith_deg": zenith, "size_arcsec": 0.0})
    for size in arguments.size_arcsec:
        experiment = of_size(beam(40.0), size, arguments.seed)
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


def beam(zenith_deg: float) -> Beam:
    """Beam of a track about transit, North of the zenith by an angle."""
    centre = PhaseCentre(0.0, math.radians(LATITUDE + zenith_deg))
    track = Track.from_clock(centre, ((-14400.0, 14400.0),), 300.0)
    plan = ObservingPlan(load_layout("ska-mid-aa4"), track, Channels.from_band(950e6, 1190e6, 1))
    return Survey(plan, (0j,), executor=in_threads(2)).alone().beam


def of_size(one: Beam, size_arcsec: float, seed: int) -> Experiment:
    """Galaxies of one size and flux, the noise such that they have a signal-to-noise ratio of ``SNR``."""
    flux = PowerLawFlux(minimum=20 * MICROJANSKY, maximum=20.002 * MICROJANSKY)
    relation = SizeFluxRelation(intercept=math.log(size_arcsec), slope=0.0)
    prior = ShapePrior(math.log(size_arcsec * ARCSEC), relation.sigma)
    snr = flux.minimum * one.stage(*_lognormal(prior)).snr_of_jansky(prior, Exponential())
    quiet = replace(one, image=one.image * (SNR / snr) ** 2, _stages={})
    population = Population(flux=flux, size=relation)
    return Experiment(quiet, (0j,), population=population, size=relation, seed=seed)


def _lognormal(prior: ShapePrior) -> tuple[float, float]:
    return prior.log_scale_length, prior.log_scale_length_sigma


def estimator_of(name: str, experiment: Experiment) -> Estimator:
    """Estimator of a name; the Bayesian one knows the population that is drawn from."""
    if name == "bayesian":
        drawn = experiment.population
        return BayesianEstimator(population=UnlensedPopulation(drawn.flux, drawn.size))
    return MeanEstimator() if name == "mean" else MomentEstimator()


def measured(arguments: argparse.Namespace, experiment: Experiment, about: dict) -> list[dict]:
    """One row a bin of flux."""
    start = time.perf_counter()
    estimator = estimator_of(arguments.estimator, experiment)
    biases = calibrate(experiment, estimator, arguments.galaxies, arguments.threads)
    psf = measure_psf(experiment.beam.image, experiment.beam.pixel)
    shape = {"psf_e1": psf.ellipticity.real, "psf_e2": psf.ellipticity.imag}
    seconds = time.perf_counter() - start
    print(f"{about}: {biases[0]}, {seconds:.0f} s", flush=True)
    first = {"estimator": arguments.estimator, "seed": arguments.seed, **about, **shape}
    return [{**first, "flux": one.name, **one.record()} for one in biases]


if __name__ == "__main__":
    np.set_printoptions(precision=2)
    main()
