"""Bias of moments in a crowded field, through simulation and extraction; SKA-Mid AA4, 8 h.

    python benchmarks/crowded_shear.py --field-arcmin 16 --density 2.8 --shear 0.03

One field behind g and -g, with e and -e, with its noise and the opposite: eight extractions.
"""

import argparse
import cmath
import math
import time
from dataclasses import replace

import numpy as np
import survey

from uvshear.calibration.bias import fit_bias
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.measurement import MeasurementOptions
from uvshear.measurement.keep import MomentStatistic
from uvshear.pipeline import extract
from uvshear.predict import predict_visibilities
from uvshear.shear.moments import moment_weight
from uvshear.simulation.lensing import shear_galaxies

BLOCKS = 50


def main() -> None:
    """Extract the eight fields, and print m and c in total and by flux."""
    arguments = parse()
    angle = cmath.rect(arguments.shear, math.pi / 4)
    shears = (angle, -angle)
    galaxies, _, noise = survey.simulate(
        arguments.field_arcmin,
        arguments.density,
        arguments.integration_s,
        arguments.seed,
        arguments.threads,
    )
    flux = galaxies.flux * 1e6
    block = np.arange(len(galaxies)) % BLOCKS
    bins = {"all": (0, 1e9), "10-20 uJy": (0, 20), "20-50 uJy": (20, 50), "50-200 uJy": (50, 1e9)}
    sums = {name: np.zeros((BLOCKS, 2, 6)) for name in bins}
    start = time.perf_counter()
    for column, shear in enumerate(shears):
        for turned in (galaxies, replace(galaxies, ellipticity=-galaxies.ellipticity)):
            for sign in (1, -1):
                terms = measured(shear_galaxies(turned, shear), noise, sign, arguments.threads)
                for name, (low, high) in bins.items():
                    chosen = (flux >= low) & (flux < high) & np.isfinite(terms).all(axis=1)
                    for k in range(6):
                        weights = terms[chosen, k]
                        sums[name][:, column, k] += np.bincount(block[chosen], weights, BLOCKS)
                print(f"{time.perf_counter() - start:.0f} s", flush=True)
    for name, (low, high) in bins.items():
        number = int(((flux >= low) & (flux < high)).sum())
        one = fit_bias(name, shears, (0j, 0j), sums[name], number)
        print(name, number, "m", one.m, "+-", one.m_err, "c", one.c, "+-", one.c_err)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--field-arcmin", type=float, default=16.0)
    parser.add_argument("--density", type=float, default=2.8, help="galaxies a square arcminute")
    parser.add_argument("--integration-s", type=float, default=900.0)
    parser.add_argument("--shear", type=float, default=0.03, help="modulus")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--threads", type=int, default=2)
    return parser.parse_args()


def measured(sky, noise: VisibilitySet, sign: int, threads: int) -> np.ndarray:
    """Weighted moments and responses of each galaxy, NaN where it has a flag."""
    block = noise.blocks[0]
    vis = predict_visibilities(sky, block.uvw, survey.FREQUENCY, threads=threads)
    data = (vis + sign * block.stokes_i).astype(np.complex64)
    observation = VisibilitySet(survey.PHASE_CENTRE, (replace(block, stokes_i=data),))
    catalogue = catalogue_from_galaxies(sky, survey.PHASE_CENTRE)
    options = MeasurementOptions(keep=(MomentStatistic(),), threads=threads)
    _, extracted = extract(observation, catalogue, options)
    terms = np.full((len(sky), 6), np.nan)
    for source, kept in extracted.kept.items():
        if extracted.measurements[source].flag.word != "ok":
            continue
        variance = np.array([(kept["m1_var"] + kept["m2_var"]) / 2])
        weight = moment_weight(sky.flux[source : source + 1], variance)[0]
        names = ("m1", "m2", "r11", "r12", "r12", "r22")
        terms[source] = weight * np.array([kept[name] for name in names])
    return terms


if __name__ == "__main__":
    main()
