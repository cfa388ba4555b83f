"""Flags of empty places, of points and of galaxies whose size the array tells, or hardly tells, from a point.

    python benchmarks/significance.py
    python benchmarks/significance.py --cases empty points --record FILE.json

Sources stand on a lattice, 70 arcsec apart for SKA-Mid and 180 arcsec for MeerKAT. The noise is that of a
signal-to-noise ratio of 10 for a galaxy of 10 uJy. All sources are listed in the catalogue as galaxies.
"""

import argparse
import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from astropy.table import Table
from record import write_record

import uvshear
from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.galaxy import Galaxies, SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.catalogue import catalogue_from_galaxies

CENTRE = PhaseCentre(0.5, np.radians(-30.0))
LENGTH = 4 * np.radians(15)


@dataclass(frozen=True)
class Case:
    """Sources observed with an array.

    Parameters
    ----------
    layout
        Name of the array.
    number
        Number of sources.
    step
        Distance between them [rad].
    flux
        Function from random numbers and a number to fluxes [Jy].
    there
        Function from the catalogue's galaxies to those that are observed.
    """

    layout: str
    number: int
    step: float
    flux: Callable[[np.random.Generator, int], np.ndarray]
    there: Callable[[Galaxies], Galaxies]


def _spread(low: float, high: float) -> Callable[[np.random.Generator, int], np.ndarray]:
    return lambda rng, count: np.exp(rng.uniform(np.log(low), np.log(high), count)) * MICROJANSKY


def _faint(rng: np.random.Generator, count: int) -> np.ndarray:
    del rng
    return np.full(count, 20 * MICROJANSKY)


def _points(sky: Galaxies) -> Galaxies:
    return replace(sky, scale_length=np.zeros(len(sky)), ellipticity=np.zeros(len(sky), complex))


SKA, MEERKAT = 70 * ARCSEC, 180 * ARCSEC
CASES: Mapping[str, Case] = {
    "empty": Case(
        "ska-mid-aa4", 1000, SKA, _spread(10, 200), lambda sky: replace(sky, flux=1e-9 * sky.flux)
    ),
    "points": Case("ska-mid-aa4", 500, SKA, _spread(10, 500), _points),
    "galaxies": Case("ska-mid-aa4", 500, SKA, _faint, lambda sky: sky),
    "meerkat": Case("meerkat", 300, MEERKAT, _faint, lambda sky: sky),
}


def main() -> None:
    """Simulate, measure, count."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", nargs="+", default=list(CASES), choices=CASES)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--record", type=Path)
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    for name in arguments.cases:
        shapes = measured(CASES[name], arguments.seed)
        found = counts(shapes, bright=name == "galaxies")
        print(name, found, flush=True)
        figures |= {f"{name}_{key}": value for key, value in found.items()}
    if arguments.record:
        title = "Flags of empty places, points and galaxies"
        write_record(arguments.record, figures, [arguments.seed], title=title)


def counts(shapes: Table, *, bright: bool) -> dict[str, float]:
    """Count the sources without a flag; ``bright`` leaves out those below a signal-to-noise ratio of 20."""
    snr = np.array(shapes["snr"])
    kept = shapes[snr >= 20] if bright else shapes
    ok = np.array(kept["flag"]) == "ok"
    modulus = np.hypot(kept["e1"], kept["e2"])
    return {
        "number": len(kept),
        "ok": int(ok.sum()),
        "ok_percent": 100 * float(ok.mean()),
        "ok_percent_err": 100
        * math.sqrt(max(ok.mean() * (1 - ok.mean()), 1 / len(kept)) / len(kept)),
        "elongated": int(np.sum(ok & (modulus > 0.8) & (np.array(kept["weight"]) > 0))),
    }


def measured(case: Case, seed: int) -> Table:
    rng = np.random.default_rng(seed)
    side = math.ceil(math.sqrt(case.number))
    index = np.arange(case.number)
    lattice = np.stack([index % side, index // side]) - side / 2
    l, m = case.step * lattice + rng.uniform(-5, 5, lattice.shape) * ARCSEC
    flux = case.flux(rng, case.number)
    sky = Galaxies(
        l=l,
        m=m,
        flux=flux,
        scale_length=np.exp(SizeFluxRelation().prior(flux).log_median),
        ellipticity=rng.uniform(0, 0.6, case.number)
        * np.exp(2j * np.pi * rng.uniform(size=case.number)),
        spectral_index=np.full(case.number, -0.7),
    )
    integration = 1800.0 if case.layout.startswith("ska") else 600.0
    plan = ObservingPlan(
        load_layout(case.layout),
        Track(CENTRE, ((-LENGTH, LENGTH),), integration),
        Channels.from_band(950e6, 1190e6, 1),
    )
    observation = uvshear.simulate(
        catalogue_from_galaxies(case.there(sky), CENTRE), plan, seed=seed
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return uvshear.measure(observation, catalogue_from_galaxies(sky, CENTRE)).shapes


if __name__ == "__main__":
    main()
