"""A simulated observation: galaxies observed by an array, with noise."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.galaxy.galaxies import Galaxies
from uvshear.galaxy.profile import Profile
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.attenuation import Attenuation, total_attenuation
from uvshear.interferometer.coverage import Coverage
from uvshear.interferometer.noise import Noise
from uvshear.interferometer.origin import Origin
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.stokes import stokes_i
from uvshear.interferometer.visibilities import Integrations, Visibilities
from uvshear.predict.losses import Losses
from uvshear.predict.prediction import Prediction
from uvshear.predict.within_error import plan_within_error
from uvshear.typing import Array, Complex, Float

SAMPLES_PER_SLAB: Final = 2**18
"""Number of visibilities whose noise comes from one stream of random numbers."""

SLABS_PER_BLOCK: Final = 4
"""Number of slabs in a block: 1 million visibilities, 25 MB with their standard deviations."""

BLOCKS_PER_PREDICTION: Final = 16
"""Number of blocks that are predicted together, because galaxies are drawn anew for every prediction."""

OF_THE_NOISE: Final = 1e-5
"""Root mean square of the error of the predicted visibilities, over the smallest noise of Stokes I."""


@dataclass(frozen=True)
class CorrelationBlock:
    """Consecutive rows of a simulated observation.

    Parameters
    ----------
    first_row
        Index of the block's first row in the coverage.
    correlations
        The two parallel hands [Jy].
    sigma
        Standard deviation of one real component of each hand [Jy].
    """

    first_row: int
    correlations: Complex[Array, "row chan corr"]
    sigma: Float[Array, "row chan corr"]

    def __len__(self) -> int:
        return len(self.correlations)


@dataclass(frozen=True)
class SimulatedObservation:
    """Visibilities of galaxies, simulated block by block whenever they are read: an Observation like a Measurement Set.

    Parameters
    ----------
    coverage
        Baselines and times.
    channels
        Frequencies.
    galaxies
        Galaxies at directions relative to the coverage's phase centre.
    profile
        Brightness profile of all galaxies.
    noise
        Noise of the correlations.
    seed
        Seed of the noise: the same seed gives the same noise, whatever the executor. With None no noise is added, but
        the weights are those of the noise.
    executor
        Executor for :meth:`chunks`.
    is_averaged
        Whether samples are averages over channels and integrations, as from a correlator; otherwise each sample is at
        one frequency and one time.
    primary_beam
        Primary beam of the dishes; none unless given.
    is_exact
        Whether visibilities are exact sums over the galaxies; otherwise they may be wrong by ``OF_THE_NOISE`` where
        there is noise.
    """

    coverage: Coverage
    channels: Channels
    galaxies: Galaxies
    profile: Profile
    noise: Noise
    seed: int | None
    executor: Executor = SERIAL
    is_averaged: bool = False
    primary_beam: Attenuation | None = None
    is_exact: bool = False

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self.coverage.phase_centre

    def expected_samples(self) -> float:
        """Return the number of samples."""
        return len(self.coverage) * len(self.channels)

    def origin(self) -> Origin:
        """Return the observation itself; without noise its weights do not describe the noise of its data."""
        return Origin(self, "the simulated observation", weights_tell_noise=self.seed is not None)

    def dish_diameters(self) -> Float[Array, " antenna"]:
        """Return the diameter of each antenna's dish [m]; 0 where the layout does not give it."""
        return np.nan_to_num(self.coverage.layout.diameters, nan=0.0)

    def pointing_direction(self) -> PhaseCentre:
        """Return the phase centre, to which all dishes point."""
        return self.phase_centre

    @property
    def averaged_width(self) -> Float[Array, " chan"]:
        """Band that each channel is averaged over [Hz]; 0 where samples are taken at one frequency."""
        return self.channels.width if self.is_averaged else np.zeros(len(self.channels))

    @property
    def rows_per_slab(self) -> int:
        """Number of rows that share a stream of random numbers; it depends on the number of channels alone."""
        return max(1, SAMPLES_PER_SLAB // len(self.channels))

    @property
    def row_ranges(self) -> list[range]:
        """Rows that are predicted together."""
        together, rows = BLOCKS_PER_PREDICTION * self._rows_per_block, len(self.coverage)
        return [range(k, min(k + together, rows)) for k in range(0, rows, together)]

    def blocks(self, executor: Executor = SERIAL) -> Iterator[CorrelationBlock]:
        """Simulate the correlations, a block of rows at a time; workers make the next blocks while one is used."""
        for rows in self.row_ranges:
            sky = self.planned(rows, executor).visibilities(executor).astype(np.complex64)
            yield from self.blocks_of(rows.start, sky, executor)

    def blocks_of(
        self, start: int, sky: Complex[Array, "row chan"], executor: Executor = SERIAL
    ) -> Iterator[CorrelationBlock]:
        """Add noise to the predicted visibilities of the rows from ``start`` on, which are one of ``row_ranges``."""

        def block(first: int) -> CorrelationBlock:
            return self._observed(sky[first : first + self._rows_per_block], start + first)

        yield from executor.map(block, range(0, len(sky), self._rows_per_block))

    def chunks(self) -> Iterator[Visibilities]:
        """Simulate Stokes I as it would be read from a Measurement Set."""
        for block in self.blocks(self.executor):
            rows = slice(block.first_row, block.first_row + len(block))
            combined = stokes_i(
                block.correlations,
                1 / block.sigma**2,
                np.zeros(block.correlations.shape, dtype=bool),
            )
            yield Visibilities(
                uvw=self.coverage.uvw[rows],
                frequency=self.channels.frequency,
                stokes_i=combined.visibilities,
                weights=combined.weights,
                width=self.averaged_width,
                integrations=self._integrations(rows),
                hand_powers=combined.hand_powers,
            )

    def planned(self, rows: range, executor: Executor = SERIAL) -> Prediction:
        """Plan the prediction of the visibilities of the galaxies [Jy], which both hands have."""
        taken = slice(rows.start, rows.stop)
        error = 0.0
        if not self.is_exact and self.seed is not None:
            error = OF_THE_NOISE * float(self._sigma(taken).min()) / math.sqrt(2)
        return plan_within_error(
            self.galaxies,
            self.coverage.rows(taken).uvw,
            self.channels.frequency,
            error,
            self.profile,
            executor,
            self._losses(taken),
        )

    @property
    def _rows_per_block(self) -> int:
        return SLABS_PER_BLOCK * self.rows_per_slab

    def _observed(self, sky: Complex[Array, "row chan"], first_row: int) -> CorrelationBlock:
        """Both hands of some rows, with their noise."""
        sigma = self._sigma(slice(first_row, first_row + len(sky)))
        correlations = np.repeat(sky[..., None], 2, axis=2)
        if self.seed is not None:
            self._add_noise(correlations, sigma, first_row // self.rows_per_slab)
        return CorrelationBlock(first_row, correlations, np.repeat(sigma[..., None], 2, axis=2))

    def _sigma(self, rows: slice) -> Float[Array, "row chan"]:
        """Noise of one real component of each hand [Jy]."""
        sigma = self.noise.correlation_sigma(self.coverage.rows(rows), self.channels)
        return sigma.astype(np.float32)

    def _integrations(self, rows: slice) -> Integrations:
        taken = self.coverage.rows(rows)
        antennas = np.column_stack([taken.antenna1, taken.antenna2])
        interval = taken.integration if self.is_averaged else 0.0
        return Integrations(antennas, taken.time, np.full(len(taken), interval))

    def _losses(self, rows: slice) -> Losses | None:
        centre = self.phase_centre
        return Losses.from_attenuation(
            total_attenuation(centre.dec, self.primary_beam, smears=self.is_averaged),
            self.averaged_width,
            self._integrations(rows),
        )

    def _add_noise(
        self,
        correlations: Complex[Array, "row chan corr"],
        sigma: Float[Array, "row chan"],
        first_slab: int,
    ) -> None:
        """Add noise in place, each slab from its own stream."""
        components = correlations.view(np.float32)
        for slab, start in enumerate(range(0, len(correlations), self.rows_per_slab), first_slab):
            rows = slice(start, start + self.rows_per_slab)
            generator = np.random.Generator(
                np.random.Philox(np.random.SeedSequence(self.seed, spawn_key=(slab,)))
            )
            deviates = generator.standard_normal(components[rows].shape, dtype=np.float32)
            deviates *= sigma[rows, :, None]
            components[rows] += deviates
