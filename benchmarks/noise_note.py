"""Sixty simulated sets, and what is said about their weights: nothing if they are right, and the ratio if not.

    python benchmarks/noise_note.py
    python benchmarks/noise_note.py --sets 6 --verbose

Three arrays, integrations of 60 to 2400 s and five skies: faint galaxies; sources of up to 20 times the noise of a
visibility; the same with a source of 40 times the noise 20 arcmin out, which the catalogue has; the same where the
catalogue lacks it; and one source of 50 times the noise near the centre. Every set is measured with right weights, with
its two parallel hands and with Stokes I alone; and, with one or the other, with a noise of 0.8, 0.894, 1.095 or 1.2
times what the weights claim (the middle two are weights that are 20 per cent off). Outcomes are counted: silent, told,
and unknown, which is the note that the noise cannot be told.
"""

import argparse
import math
import time
import warnings
from collections import Counter
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from record import RESULTS, write_record

import uvshear
from uvshear.constants import ARCMIN, MICROJANSKY
from uvshear.execution import in_threads
from uvshear.galaxy import DiscEllipticityPrior, Galaxies, PowerLawFlux, SizeFluxRelation
from uvshear.interferometer import Channels, ObservingPlan, PhaseCentre, Track, load_layout
from uvshear.interferometer.layout import ArrayLayout
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.simulation.population import Population, draw_population
from uvshear.simulation.sky_region import SquareField

ARRAYS = {"ska-mid-aa4": -30.0, "meerkat": -30.0, "vla-a": 40.0}
"""Declination of the field for each array [degrees]."""

ANTENNAS = 20
INTEGRATIONS = (60.0, 300.0, 900.0, 2400.0)
SKIES = ("faint", "bright", "far", "missing", "dominant")
CHANNELS = Channels.from_band(1.30e9, 1.34e9, 4)
NOISE = (0.8, math.sqrt(0.8), math.sqrt(1.2), 1.2)
"""Noise over what wrong weights claim."""

GALAXIES = 3


@dataclass(frozen=True)
class Case:
    """A set to be simulated."""

    array: str
    integration: float
    sky: str
    number: int

    @property
    def is_averaged(self) -> bool:
        """Whether visibilities are averages, as from a correlator; those of distant sources are taken as points.

        Averages over 10 MHz and a minute would leave next to nothing of a source 20 arcmin out.
        """
        return self.integration <= 300 and self.sky not in ("far", "missing")


def main() -> None:
    """Simulate, measure, count, record."""
    arguments = parse()
    cases = [Case(*setting, number) for number, setting in enumerate(settings())]
    chosen = cases[:: max(1, len(cases) // arguments.sets)]
    told: Counter[str] = Counter()
    errors: list[float] = []
    start = time.perf_counter()
    for case in chosen:
        observation, catalogue = simulated(case)
        noise = NOISE[case.number % len(NOISE)]
        trials = ((True, 1.0), (False, 1.0), (case.number // len(SKIES) % 2 == 0, noise))
        for has_hands, ratio in trials:
            notes = measured(with_weights(observation, ratio, has_hands), catalogue)
            outcome = judged(notes, ratio)
            kind = (
                f"{'right' if ratio == 1 else 'wrong'}_{'two_hands' if has_hands else 'stokes_i'}"
            )
            told[f"{kind}_{outcome}"] += 1
            if outcome == "told":
                errors.append(float(notes[0].split(" times")[0].split()[-1]) / ratio - 1)
            if arguments.verbose:
                print(case, f"{kind} {ratio:.3f} {outcome}", *notes, flush=True)
    figures = {"sets": len(chosen)} | {
        f"{kind}_{outcome}": told[f"{kind}_{outcome}"]
        for kind in ("right_two_hands", "right_stokes_i", "wrong_two_hands", "wrong_stokes_i")
        for outcome in ("silent", "told", "unknown")
    }
    figures["ratio_error_rms"] = float(np.sqrt(np.mean(np.square(errors)))) if errors else 0.0
    for name, value in figures.items():
        print(f"{name:28} {value:.4g}")
    print(f"{time.perf_counter() - start:.0f} s")
    if len(chosen) == len(cases):
        title = "Notes about the weights of sixty simulated sets, right and wrong"
        seeds = [case.number for case in cases]
        write_record(RESULTS / "noise_note.json", figures, seeds, title=title)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--sets", type=int, default=60, help="number of sets, spread over all")
    parser.add_argument("--verbose", action="store_true", help="print every measurement")
    return parser.parse_args()


def settings() -> list[tuple[str, float, str]]:
    return list(product(ARRAYS, INTEGRATIONS, SKIES))


def simulated(case: Case) -> tuple[VisibilitySet, uvshear.Catalogue]:
    """Simulate the set with its noise, and the catalogue with which it is measured."""
    rng = np.random.default_rng(case.number)
    centre = PhaseCentre(0.3, math.radians(ARRAYS[case.array]))
    hours = min(8, case.integration / 60)
    track = Track.from_clock(centre, ((-1800.0 * hours, 1800.0 * hours),), case.integration)
    plan = ObservingPlan(thinned(case.array, rng), track, CHANNELS, is_averaged=case.is_averaged)
    sky = uvshear.simulate(catalogue_from_galaxies(galaxies(1.0, rng), centre), plan)
    sigma = sky.noise.correlation_sigma(sky.coverage, CHANNELS)[0, 0] / math.sqrt(2)
    truth, known = populated(case.sky, float(sigma), rng)
    observation = replace(sky, galaxies=truth, seed=case.number + 1)
    blocks = VisibilitySet(centre, tuple(observation.chunks()))
    return blocks, catalogue_from_galaxies(known, centre)


def thinned(name: str, rng: np.random.Generator) -> ArrayLayout:
    layout = load_layout(name)
    chosen = np.sort(rng.permutation(len(layout))[:ANTENNAS])
    return replace(
        layout,
        antenna_names=tuple(layout.antenna_names[k] for k in chosen),
        positions=layout.positions[chosen],
        diameters=layout.diameters[chosen],
    )


def populated(kind: str, sigma: float, rng: np.random.Generator) -> tuple[Galaxies, Galaxies]:
    """Return the true sky and the part of it that the catalogue has; ``sigma`` is the noise of a visibility [Jy]."""
    if kind == "faint":
        sky = galaxies(1.0, rng)
        return sky, sky
    if kind == "dominant":
        sky = with_source(galaxies(1.0, rng), 50 * sigma, 0.5 * ARCMIN)
        return sky, sky
    near = galaxies(1.0, rng)
    near = replace(near, flux=near.flux / near.flux.max() * 20 * sigma)
    if kind == "bright":
        return near, near
    whole = with_source(near, 40 * sigma, 20 * ARCMIN)
    return whole, whole if kind == "far" else near


def galaxies(scale: float, rng: np.random.Generator) -> Galaxies:
    population = Population(
        PowerLawFlux(minimum=10 * MICROJANSKY, maximum=200 * MICROJANSKY),
        SizeFluxRelation(),
        DiscEllipticityPrior(),
    )
    sky = draw_population(population, SquareField(5 * ARCMIN), number=GALAXIES, rng=rng)
    return replace(sky, flux=scale * sky.flux)


def with_source(sky: Galaxies, flux: float, distance: float) -> Galaxies:
    """Add a point source to the East of the centre."""
    return replace(
        sky,
        l=np.append(sky.l, distance),
        m=np.append(sky.m, 0.3 * distance),
        flux=np.append(sky.flux, flux),
        scale_length=np.append(sky.scale_length, 0.0),
        ellipticity=np.append(sky.ellipticity, 0.0),
        spectral_index=np.append(sky.spectral_index, -0.7),
    )


def with_weights(observation: VisibilitySet, ratio: float, has_hands: bool) -> VisibilitySet:
    """Change the weights such that the noise is ``ratio`` times what they claim."""
    blocks = []
    for block in observation.blocks:
        powers = block.hand_powers * ratio**2 if has_hands else None
        weights = (block.weights * ratio**2).astype(np.float32)
        blocks.append(replace(block, weights=weights, hand_powers=powers))
    return VisibilitySet(observation.phase_centre, tuple(blocks))


def measured(observation: VisibilitySet, catalogue: uvshear.Catalogue) -> list[str]:
    """Measure a set, and return what was said about its weights."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", uvshear.DataWarning)
        uvshear.measure(observation, catalogue, resources=uvshear.Resources(executor=in_threads(1)))
    texts = [str(warning.message) for warning in caught]
    return [text for text in texts if "the weights" in text]


def judged(notes: list[str], ratio: float) -> str:
    """Say in a word what the notes are."""
    if not notes:
        return "silent"
    return "unknown" if "cannot be told" in notes[0] else "told"


if __name__ == "__main__":
    main()
