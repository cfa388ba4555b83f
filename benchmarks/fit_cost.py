"""CPU time of one fit at the facet sizes of Rivi & Miller 2018, Table 1, on one core.

A galaxy of each flux bin, of median size, on SKA-Mid AA4. The update starts from the galaxy of a round before, as
sweeps do; "from scratch" looks for the peak first. Their C++ program needs 3 s of this class of machine.

    python benchmarks/fit_cost.py
"""

import math
import time
from collections.abc import Callable

import numpy as np

from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.execution import in_threads
from uvshear.extraction.paper.cell_average import CellAverageFacets, PaperTable
from uvshear.extraction.paper.exact import ExactFacets
from uvshear.extraction.paper.facets import Target
from uvshear.galaxy import Exponential, Galaxies, SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Visibilities
from uvshear.predict import predict_visibilities
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import fit_galaxy, measure_shape

FREQUENCY = np.array([1.07e9])
FLUXES = np.array([175.0, 125.0, 90.0, 70.0, 50.0, 30.0, 15.0]) * MICROJANSKY
REPEATS = 7


def main() -> None:
    """Time every bin for both kinds of facet."""
    track = Track.from_clock(PhaseCentre(0.0, math.radians(-30)), ((-14400.0, 14400.0),), 900.0)
    uvw = synthesise(load_layout("ska-mid-aa4"), track).uvw
    print(f"{len(uvw)} rows; CPU milliseconds, median of {REPEATS}")
    print("facet         flux/uJy  SNR   cells   from scratch  update  posterior")
    for name, method in (
        ("exact", ExactFacets()),
        ("cell-average", CellAverageFacets(PaperTable())),
    ):
        for flux in FLUXES:
            for snr in (10.0, 100.0, 2000.0):
                time_fit(name, method, uvw, float(flux), snr)


def time_fit(name: str, method, uvw: np.ndarray, flux: float, snr: float) -> None:
    profile = Exponential()
    size = float(SizeFluxRelation().median(np.array([flux]))[0])
    galaxy = single(flux, size, 0.2 + 0.1j)
    vis = predict_visibilities(galaxy, uvw, FREQUENCY, profile, executor=in_threads(2))
    sigma = math.sqrt(float(np.sum(np.abs(vis) ** 2))) / snr
    rng = np.random.default_rng(1)
    noisy = vis + sigma * (rng.normal(size=vis.shape) + 1j * rng.normal(size=vis.shape))
    model = single(flux, size, 0j)
    residual = noisy - predict_visibilities(model, uvw, FREQUENCY, profile, executor=in_threads(2))
    weights = np.full(vis.shape, sigma**-2)
    longest = float(np.hypot(uvw[:, 0], uvw[:, 1]).max() * FREQUENCY[0] / 299792458.0)
    builder = method.open(Target(model, size, UvRange(0, longest), FREQUENCY[0]), profile)
    builder.add(Visibilities(uvw, FREQUENCY, residual, weights), model)
    facet = builder.facet(model)
    prior = ShapePrior(math.log(size), 0.3136)
    start = fit_galaxy(facet, prior, profile)
    scratch = cpu_time(lambda: fit_galaxy(facet, prior, profile))
    update = cpu_time(lambda: fit_galaxy(facet, prior, profile, start))
    posterior = cpu_time(lambda: measure_shape(facet, prior, profile, start))
    print(
        f"{name:12s}  {flux / MICROJANSKY:7.0f} {snr:5.0f}  {len(facet.uv):6d}  "
        f"{scratch:12.1f}  {update:6.1f}  {posterior:9.1f}"
    )


def single(flux: float, size: float, e: complex) -> Galaxies:
    place = 1000 * ARCSEC
    return Galaxies(*(np.array([value]) for value in (place, place, flux, size, complex(e), -0.7)))


def cpu_time(function: Callable[[], object]) -> float:
    times = []
    for _ in range(REPEATS):
        start = time.thread_time()
        function()
        times.append(1e3 * (time.thread_time() - start))
    return float(np.median(times))


if __name__ == "__main__":
    main()
