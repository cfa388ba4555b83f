"""What a sky that the catalogue does not hold does to the shapes of the galaxies that it does hold.

    python benchmarks/unmodelled.py

One field of 8' with 179 galaxies, measured with the right catalogue and with wrong ones. For the galaxies measured both
times: rms change of e over its error, of all and of those within 10 arcsec of what is wrong, slopes, and flags.
"""

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import survey
from astropy.table import Table

import uvshear
from uvshear.constants import ARCMIN, ARCSEC, MICROJANSKY
from uvshear.diagnostics.slope import fit_slope, population_weights
from uvshear.execution import in_threads
from uvshear.galaxy import Exponential, Galaxies
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.catalogue import Catalogue, catalogue_from_galaxies
from uvshear.pipeline.sample import FITTED
from uvshear.predict import predict_visibilities

NEAR = 10 * ARCSEC
STAR = 1000 * 50 * MICROJANSKY
"""A thousand times the flux of a galaxy."""


def main() -> None:
    """Measure one way after the other."""
    galaxies, observation, _ = survey.simulate(8.0, 2.8, 600.0, seed=11, executor=in_threads(2))
    whole = catalogue_from_galaxies(galaxies, survey.PHASE_CENTRE)
    right = measure(observation, whole)
    print("case                                  change  near    slopes         flags")
    tell("the right catalogue", galaxies, right, right, np.zeros((0, 2)))

    rng = np.random.default_rng(5)
    missing = np.sort(rng.permutation(len(galaxies))[: len(galaxies) // 20])
    kept = np.setdiff1d(np.arange(len(galaxies)), missing)
    lacking = replace_sources(whole, kept)
    where = np.column_stack([galaxies.l, galaxies.m])
    tell(
        "one galaxy in twenty is missing",
        galaxies.select(kept),
        right[kept],
        measure(observation, lacking),
        where[missing],
    )

    twice = rng.permutation(len(galaxies))[:5]
    doubled = replace_sources(whole, np.concatenate([np.arange(len(galaxies)), twice]))
    tell(
        "five galaxies are there twice",
        galaxies,
        right,
        measure(observation, doubled),
        where[twice],
    )

    star = place(5.0 * ARCMIN, -4.5 * ARCMIN, STAR)
    with_star = add(observation, star)
    known = join(whole, star)
    tell(
        "a star of 50 mJy, 6.7' off, known", galaxies, right, measure(with_star, known), spot(star)
    )
    wrong = replace(known, flux=known.flux * np.where(known.is_point, 1.1, 1.0))
    tell("the same, its flux 10 % off", galaxies, right, measure(with_star, wrong), spot(star))
    faint = place(0.4 * ARCMIN, 0.3 * ARCMIN, STAR / 1000)
    seen = add(observation, faint)
    tell("an unknown point of 50 uJy", galaxies, right, measure(seen, whole), spot(faint))
    for flux, name in ((STAR / 100, "0.5"), (STAR, "50")):
        outside = place(30 * ARCMIN, 10 * ARCMIN, flux)
        seen = add(observation, outside)
        shapes = measure(seen, whole)
        tell(f"an unknown star of {name} mJy 32' off", galaxies, right, shapes, spot(outside))


def measure(observation: VisibilitySet, catalogue: Catalogue) -> Table:
    resources = uvshear.Resources(executor=in_threads(2))
    return uvshear.measure(observation, catalogue, resources=resources).shapes


def replace_sources(catalogue: Catalogue, index: np.ndarray) -> Catalogue:
    names = ("flux", "spectral_index", "scale_length", "ellipticity", "ra", "dec")
    columns = {name: getattr(catalogue, name)[index] for name in names}
    return replace(catalogue, identifier=np.arange(len(index)), **columns)


def place(l: float, m: float, flux: float) -> Galaxies:
    one = np.ones(1)
    return Galaxies(l * one, m * one, flux * one, 0 * one, 0j * one, -0.7 * one)


def spot(source: Galaxies) -> np.ndarray:
    return np.column_stack([source.l, source.m])


def add(observation: VisibilitySet, source: Galaxies) -> VisibilitySet:
    (block,) = observation.blocks
    vis = predict_visibilities(source, block.uvw, block.frequency, Exponential(), in_threads(2))
    return replace(observation, blocks=(block.with_stokes_i(block.stokes_i + vis),))


def join(catalogue: Catalogue, star: Galaxies) -> Catalogue:
    other = catalogue_from_galaxies(star, survey.PHASE_CENTRE)
    names = ("flux", "spectral_index", "scale_length", "ellipticity", "ra", "dec")
    columns = {
        name: np.concatenate([getattr(catalogue, name), getattr(other, name)]) for name in names
    }
    count = len(columns["flux"])
    is_point = np.arange(count) == count - 1
    return replace(catalogue, identifier=np.arange(count), is_point=is_point, **columns)


def tell(name: str, galaxies: Galaxies, right: Table, table: Table, wrong: np.ndarray) -> None:
    """Print a line; the first rows of ``table`` are the galaxies."""
    shapes = table[: len(galaxies)]
    both = np.isin(np.array(shapes["flag"]), FITTED) & np.isin(np.array(right["flag"]), FITTED)
    parts = (("e1", galaxies.ellipticity.real), ("e2", galaxies.ellipticity.imag))
    change = np.stack([(shapes[e] - right[e]) / right[f"{e}_err"] for e in ("e1", "e2")])
    place_ = np.column_stack([galaxies.l, galaxies.m])
    near = np.zeros(len(galaxies), bool)
    for one in wrong:
        near |= np.hypot(*(place_ - one).T) < NEAR
    slopes = [slope(part[both], shapes[both], e) for e, part in parts]
    beside = f"{rms(change[:, both & near]):.2f}" if (both & near).any() else "-"
    everywhere = f"{rms(change[:, both]):.3f}" if both.any() else "-    "
    flags = Counter(map(str, table["flag"]))
    words = ", ".join(f"{n} {flag}" for flag, n in flags.items())
    print(
        f"{name:36s}  {everywhere}   {beside:5s}   {' '.join(slopes)}    {words}",
        flush=True,
    )


def slope(true: np.ndarray, shapes: Table, e: str) -> str:
    if len(true) < 2:
        return "-    "
    measured, error = np.array(shapes[e]), np.array(shapes[f"{e}_err"])
    return f"{fit_slope(true, measured, error, population_weights).value:.3f}"


def rms(values: np.ndarray) -> float:
    return math.sqrt(float(np.mean(values**2)))


if __name__ == "__main__":
    main()
