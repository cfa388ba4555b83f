"""An observation after the first pass over it, with the sources of a catalogue placed in it."""

from dataclasses import dataclass
from typing import Self

from uvshear.extraction import Field, MeasurementOptions
from uvshear.galaxy import Galaxies
from uvshear.interferometer.expected_samples import expected_samples
from uvshear.interferometer.first_pass import FirstPass, first_pass
from uvshear.interferometer.held_observation import HELD_PART, held_by_parts, release
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.io.catalogue import Catalogue
from uvshear.pipeline.data_checks import DataChecks
from uvshear.pipeline.field import field_of_catalogue
from uvshear.predict.gridded import Gridding
from uvshear.progress import Meter, Progress, Stage


@dataclass(frozen=True)
class Prepared:
    """What is known before the sources are measured.

    Parameters
    ----------
    observation
        The observation.
    held
        The same observation; the visibilities of each part stay in memory after the first pass if they fit.
    sources
        The catalogue.
    options
        Options of the measurement.
    first
        Results of the first pass.
    field
        The sources in the field.
    checks
        Comparison of the data with skies.
    """

    observation: Observation
    held: Observation
    sources: Catalogue
    options: MeasurementOptions
    first: FirstPass
    field: Field
    checks: DataChecks

    @classmethod
    def from_observation(
        cls,
        observation: Observation,
        sources: Catalogue,
        options: MeasurementOptions,
        progress: Progress | None = None,
    ) -> Self:
        """Read an observation once, and place the sources."""
        meter = Meter.of_stages(progress)
        size = expected_samples(observation)
        meter.begin(Stage("first pass", amount=size, unit="visibilities"))
        model, method, executor = options.model, options.method, options.resources.executor
        memory = HELD_PART * options.resources.memory
        held = held_by_parts(observation, memory, Gridding().rows_block)
        first = first_pass(held, executor, meter.add)
        meter.begin(Stage("preparation"))
        field = field_of_catalogue(sources, observation.phase_centre, first.summary, model, method)
        field = method.extraction.within_reach(field)
        attenuated = method.extraction.models_attenuation
        checks = DataChecks(observation, first.noise_samples, model, attenuated, executor)
        return cls(observation, held, sources, options, first, field, checks)

    def with_noise_of_data(
        self, sky: Galaxies, uv_range: UvRange, progress: Progress | None = None
    ) -> Self:
        """Correct the weights that are to agree with the noise of the data; the same object if nothing is to be done.

        Parameters
        ----------
        sky
            Sky whose residual tells the noise.
        uv_range
            Baselines on which the sky describes the data.
        """
        if not self.checks.takes_noise_from_data:
            return self
        corrected = self.checks.with_noise_of_data(sky, uv_range)
        if corrected is None:
            return self
        release(self.held)
        return self.from_observation(corrected, self.sources, self.options, progress)
