"""Shapes from heavily averaged visibilities: fields of 20 arcmin, seen by the VLA (A) with long channels and times.

    python benchmarks/averaging.py --kept 0.95 0.84 0.6 --seeds 1 2 3 4
    python benchmarks/averaging.py --kept 0.84 --noise --primary-beam --record FILE.json

Channels and integrations grow together (20 s for 8 MHz) until the image of a point at the edge of the field keeps a
fraction ``--kept`` of its peak. Without noise the largest error of e is of interest; with noise it is the width of
(measured - true)/error. Galaxies whose rows are flagged are counted and left out.
"""

import argparse
import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from record import write_record
from scipy.optimize import brentq

import uvshear
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.execution import SERIAL
from uvshear.galaxy import CatalogueSize, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.attenuation import Attenuation, total_attenuation
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.primary_beam import CosineCubedBeam
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.summary import summarise
from uvshear.io.catalogue import catalogue_from_galaxies

CENTRE = PhaseCentre(0.5, np.radians(34.0))
HALF = 10 * ARCMIN
LAYOUT = load_layout("vla-a")
DIAMETER = 56.0
"""Diameter of dishes whose power beam falls to 20 per cent at 10 arcmin, half of the width of the field [m]; in the
corners of the field it is below 3 per cent."""
HOURS = np.radians(15) * np.linspace(-3.5, 3.5, 16)
LENGTH = 0.025 * np.radians(15)
"""Hour angles in the middle of the parts of the observation, and the length of each."""


@dataclass(frozen=True)
class Result:
    """Errors of e of the galaxies that were measured, their uncertainties, and the number of the others."""

    error: np.ndarray
    sigma: np.ndarray
    flagged: int
    seconds: float


def main() -> None:
    """Simulate, measure, print, record."""
    arguments = parse()
    figures: dict[str, float] = {}
    for kept in arguments.kept:
        results = [measured(kept, seed, arguments) for seed in arguments.seeds]
        name = f"kept_{round(100 * kept)}"
        figures |= {f"{name}_{key}": value for key, value in summary(results).items()}
        print(name, summary(results), flush=True)
    if arguments.record is not None:
        noise, beam = (
            "with" if x else "without" for x in (arguments.noise, arguments.primary_beam)
        )
        title = f"Shapes under heavy averaging, {noise} noise, {beam} a primary beam"
        write_record(arguments.record, figures, arguments.seeds, title=title)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument(
        "--kept", type=float, nargs="+", default=[0.84], help="of the peak at the edge"
    )
    parser.add_argument("--galaxies", type=int, default=30, help="in each field")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    parser.add_argument("--noise", action="store_true")
    parser.add_argument("--primary-beam", action="store_true")
    parser.add_argument("--circle", action="store_true", help="no galaxies in the corners")
    parser.add_argument("--record", type=Path)
    return parser.parse_args()


def summary(results: list[Result]) -> Mapping[str, float]:
    error = np.concatenate([result.error for result in results])
    sigma = np.concatenate([result.sigma for result in results])
    pull = float(np.sqrt(np.mean((error / sigma) ** 2)))
    return {
        "fits": len(error) // 2,
        "flagged": sum(result.flagged for result in results),
        "largest_error": float(np.abs(error).max()),
        "pull": pull,
        "pull_err": pull / np.sqrt(2 * len(error)),
        "median_sigma": float(np.median(sigma)),
        "cpu_s": sum(result.seconds for result in results) / len(results),
    }


def measured(kept: float, seed: int, arguments: argparse.Namespace) -> Result:
    dishes = np.full(len(LAYOUT), DIAMETER)
    beam = CosineCubedBeam.from_diameters(dishes) if arguments.primary_beam else None
    plan = plan_of(kept, beam)
    sky = galaxies(arguments.galaxies, seed, arguments.noise)
    if arguments.circle:
        sky = within_circle(sky)
    drawn = seed if arguments.noise else None
    seen = uvshear.simulate(catalogue_from_galaxies(sky, CENTRE), plan, seed=drawn)
    # Fluxes are in units of the noise of a point source.
    sky = replace(sky, flux=sky.flux / np.sqrt(summarise(seen).weight))
    catalogue = catalogue_from_galaxies(sky, CENTRE)
    seen = uvshear.simulate(catalogue, plan, noise=seen.noise, seed=drawn)
    started = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = uvshear.Model(size=CatalogueSize(), primary_beam=beam)
        shapes = uvshear.measure(
            seen, catalogue, model=model, resources=uvshear.Resources(SERIAL)
        ).shapes
    seconds = time.process_time() - started
    good = np.array(shapes["flag"]) == "ok"
    error = [shapes["e1"] - sky.ellipticity.real, shapes["e2"] - sky.ellipticity.imag]
    sigma = [shapes["e1_err"], shapes["e2_err"]]
    error, sigma = (np.concatenate([np.array(x)[good] for x in both]) for both in (error, sigma))
    return Result(error, sigma, int(np.count_nonzero(~good)), seconds)


def plan_of(kept: float, beam: Attenuation | None) -> ObservingPlan:
    """Stretch channels and integrations until the peak of a point at the edge keeps a fraction of its flux."""
    smears = total_attenuation(CENTRE.dec)
    probes = summarise(uvshear.simulate(_nobody(), _plan(1.0, None))).probes

    def lost(stretch: float) -> float:
        longer = replace(
            probes, bandwidth=probes.bandwidth * stretch, interval=probes.interval * stretch
        )
        return float(np.average(smears.factor(longer, HALF, 0.0), weights=probes.weights)) - kept

    return _plan(brentq(lost, 0.01, 2.0), beam)


def _plan(stretch: float, beam: Attenuation | None) -> ObservingPlan:
    hours = tuple((hour - LENGTH / 2, hour + LENGTH / 2) for hour in HOURS)
    channels = Channels(np.array([1.3e9, 1.45e9]), np.full(2, 8e6 * stretch))
    return ObservingPlan(LAYOUT, Track(CENTRE, hours, 20 * stretch), channels, True, beam)


def _nobody() -> object:
    return catalogue_from_galaxies(galaxies(1, 1, False), CENTRE)


def galaxies(number: int, seed: int, noise: bool) -> Galaxies:
    rng = np.random.default_rng(seed)
    low, high = (100, 3000) if noise else (2000, 10000)
    return Galaxies(
        l=rng.uniform(-HALF, HALF, number),
        m=rng.uniform(-HALF, HALF, number),
        flux=np.exp(rng.uniform(np.log(low), np.log(high), number)),
        scale_length=np.exp(rng.normal(np.log(1.2), 0.3, number)) * ARCSEC,
        ellipticity=rng.uniform(0, 0.7, number) * np.exp(2j * np.pi * rng.uniform(size=number)),
        spectral_index=rng.uniform(-1.2, -0.2, number),
    )


def within_circle(sky: Galaxies) -> Galaxies:
    """Map the square to the circle within it: every smaller square becomes a circle."""
    side, radius = np.maximum(np.abs(sky.l), np.abs(sky.m)), np.hypot(sky.l, sky.m)
    return replace(sky, l=sky.l * side / radius, m=sky.m * side / radius)


if __name__ == "__main__":
    main()
