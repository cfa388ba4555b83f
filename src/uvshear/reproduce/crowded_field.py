"""Crowded fields, simulated and measured whole: in the way of the paper, or with the converged extraction."""

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from uvshear.bias.isolated import FITTED
from uvshear.constants import ARCMIN
from uvshear.errors import DataWarning
from uvshear.execution import SERIAL, Resources
from uvshear.extraction import ConvergedExtraction, Extraction, Method, PaperExtraction
from uvshear.interferometer.coverage import synthesise
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.pipeline.measure import measure
from uvshear.predict.within_error import predict_within_error
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.shape_sample import FLAGS
from uvshear.simulation.lensing import shear_at_fixed_scale_length
from uvshear.simulation.noise_level import GalaxyNoise
from uvshear.simulation.population import Population, draw_population
from uvshear.simulation.sky_region import SquareField
from uvshear.typing import Array

EXTRACTIONS: Mapping[str, Extraction] = {
    "paper": PaperExtraction(),
    "converged": ConvergedExtraction(),
}
"""The extraction of the paper with the facets of Table 1, and that of this package."""

WORDS = {"paper": "the paper's way", "converged": "converged extraction"}
"""Names of the extractions for the reader."""


@dataclass(frozen=True)
class CrowdedField:
    """A square field of galaxies with noise, and the extraction that measures it.

    Parameters
    ----------
    extraction
        Name in ``EXTRACTIONS``.
    pointing
        The observation.
    galaxies
        Number of galaxies, a multiple of the ring.
    density
        Number of galaxies per square arcminute.
    ring
        Number of galaxies that share size, flux and abs(e), with e equally spaced on a circle.
    seed
        Seed of galaxies and noise.
    shears
        Shears of which one is applied, in the frame of (l, m), with constant scale lengths as in the paper.
    shear
        Which of them is applied.
    """

    extraction: str
    pointing: PaperPointing
    galaxies: int
    density: float
    ring: int = 1
    seed: int = 1
    shears: tuple[complex, ...] = (0j,)
    shear: int = 0

    @property
    def seconds(self) -> float:
        """Estimated processor time [s]."""
        duration = sum(stop - start for start, stop in self.pointing.times)
        samples = (
            math.comb(len(self.pointing.plan.layout), 2) * duration / self.pointing.integration
        )
        if self.extraction == "paper":
            return self.galaxies * (0.025 + 3.5e-8 * samples)
        return self.galaxies * 0.06 + 1e-5 * samples

    def measured(self) -> dict[str, Array]:
        """Return the columns of a ``ShapeSample`` for all galaxies."""
        rng = np.random.default_rng(self.seed)
        side = math.sqrt(self.galaxies / self.density) * ARCMIN
        population = Population(ring=self.ring)
        galaxies = draw_population(population, SquareField(side), number=self.galaxies, rng=rng)
        galaxies = shear_at_fixed_scale_length(galaxies, self.shears[self.shear])
        plan = self.pointing.plan
        baselines = synthesise(plan.layout, plan.track)
        sigma = GalaxyNoise().scaled_to(baselines, plan.channels, FITTED).stokes_i_sigma
        frequency = plan.channels.frequency
        model = predict_within_error(
            galaxies, baselines.uvw, frequency, 1e-5 * sigma, FITTED, SERIAL
        )
        noise = rng.normal(size=model.shape) + 1j * rng.normal(size=model.shape)
        data = (model + sigma * noise).astype(np.complex64)
        weights = np.full(model.shape, sigma**-2, np.float32)
        centre = plan.track.phase_centre
        block = Visibilities(baselines.uvw, frequency, data, weights)
        with warnings.catch_warnings():
            # Simulated weights are right; a coarse track may make the scatter of neighbouring samples look otherwise.
            warnings.simplefilter("ignore", DataWarning)
            shapes = measure(
                VisibilitySet(centre, (block,)),
                catalogue_from_galaxies(galaxies, centre),
                method=Method(extraction=EXTRACTIONS[self.extraction]),
                resources=Resources(SERIAL),
            ).shapes
        words = [flag.word for flag in FLAGS]
        numbers = np.arange(self.galaxies)
        columns: dict[str, Array] = {
            name: np.ma.filled(np.ma.asarray(shapes[name], float), np.nan)
            for name in ("e1", "e2", "e1_err", "e2_err", "e_sigma", "snr")
        }
        return {
            # Galaxies of a ring are left out together by the jackknife.
            "galaxy": numbers // self.ring + self.seed * 1_000_000,
            "shear": np.full(self.galaxies, self.shear),
            "realisation": numbers % self.ring,
            "flux": galaxies.flux,
            "true": galaxies.ellipticity,
            "measured": columns["e1"] + 1j * columns["e2"],
            "error": np.column_stack([columns["e1_err"], columns["e2_err"]]),
            "e_sigma": columns["e_sigma"],
            "snr": columns["snr"],
            "flag": np.array([words.index(str(word)) for word in shapes["flag"]]),
        }
