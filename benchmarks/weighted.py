"""Errors of shapes from weights other than the natural ones: the width of (measured - true)/error, and what they cost.

    python benchmarks/weighted.py

Galaxies of 90 to 110 uJy at an SNR of 60 or so in 24', SKA-Mid AA2 for 8 h at a declination of 10 deg, baselines of
3000 wavelengths and more; every weighting measures the same data. Widths are by the median, which outliers leave alone.
"""

import argparse
import math

import numpy as np

import uvshear
from uvshear.constants import ARCSEC, MICROJANSKY, SPEED_OF_LIGHT
from uvshear.execution import in_threads
from uvshear.galaxy import DiscEllipticityPrior, Galaxies, PowerLawFlux, SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.interferometer.weighting import Briggs, GaussianTaper, RoundPsf, Uniform
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.pipeline.sample import FITTED
from uvshear.predict import predict_visibilities
from uvshear.simulation.population import Population, draw_population
from uvshear.simulation.sky_region import SquareField

CENTRE = PhaseCentre(0.3, math.radians(10.0))
FREQUENCY = np.array([1.07e9])
CELLS = math.radians(0.2)
WEIGHTINGS = {
    "natural": (),
    "taper 1.5 arcsec": (GaussianTaper(1.5 * ARCSEC),),
    "taper 4 arcsec": (GaussianTaper(4 * ARCSEC),),
    "round": (RoundPsf(),),
    "Briggs 0": (Briggs(0.0, CELLS),),
    "Briggs 0, taper 1 arcsec": (Briggs(0.0, CELLS), GaussianTaper(ARCSEC)),
    "uniform, taper 1 arcsec": (Uniform(CELLS), GaussianTaper(ARCSEC)),
}


def main() -> None:
    """Observe once, measure with every weighting, print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--galaxies", type=int, default=240)
    parser.add_argument("--seed", type=int, default=12)
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    galaxies, observation = observe(arguments.galaxies, arguments.seed)
    catalogue = catalogue_from_galaxies(galaxies, CENTRE)
    true = {"e1": galaxies.ellipticity.real, "e2": galaxies.ellipticity.imag}
    for name, weightings in WEIGHTINGS.items():
        method = uvshear.Method(weightings=weightings)
        resources = uvshear.Resources(executor=in_threads(arguments.threads))
        shapes = uvshear.measure(observation, catalogue, method=method, resources=resources).shapes
        good = np.isin(np.array(shapes["flag"]), FITTED)
        pull = np.concatenate([((shapes[e] - true[e]) / shapes[f"{e}_err"])[good] for e in true])
        width = 1.4826 * np.median(np.abs(pull))
        error = np.median(np.array(shapes["e1_err"])[good])
        print(f"{name:25} {good.sum()} galaxies, width {width:.2f}, error {error:.4f}", flush=True)


def observe(number: int, seed: int) -> tuple[Galaxies, VisibilitySet]:
    rng = np.random.default_rng(seed)
    population = Population(
        PowerLawFlux(minimum=90 * MICROJANSKY, maximum=110 * MICROJANSKY),
        SizeFluxRelation(),
        DiscEllipticityPrior(),
    )
    field = SquareField(math.radians(0.4))
    galaxies = draw_population(population, field, number=number, rng=rng)
    track = Track.from_clock(CENTRE, ((-14400.0, 14400.0),), 1200.0)
    uvw = synthesise(load_layout("ska-mid-aa2"), track).uvw
    uvw = uvw[np.hypot(uvw[:, 0], uvw[:, 1]) * FREQUENCY[0] / SPEED_OF_LIGHT > 3e3]
    vis = predict_visibilities(galaxies, uvw, FREQUENCY)
    sigma = 100 * MICROJANSKY / 90 * math.sqrt(len(uvw))
    vis = vis + sigma * (rng.normal(size=vis.shape) + 1j * rng.normal(size=vis.shape))
    weights = np.full(vis.shape, sigma**-2)
    block = Visibilities(uvw, FREQUENCY, vis.astype(np.complex64), weights)
    return galaxies, VisibilitySet(CENTRE, (block,))


if __name__ == "__main__":
    main()
