"""What is known before the sources are measured, and how weights are corrected."""

import numpy as np
import pytest

from tests.pipeline.fields import METHOD, MODEL, catalogue_of_sky
from tests.pipeline.simulated_sets import changed, simulated_set, sky_of
from tests.progress.heard import Heard
from uvshear.execution import Resources, Serial
from uvshear.extraction import MeasurementOptions
from uvshear.interferometer.scaled_observation import ScaledObservation
from uvshear.interferometer.uv_range import UvRange
from uvshear.pipeline.prepared import Prepared

OPTIONS = MeasurementOptions(MODEL, METHOD, Resources(Serial()))
SKY = sky_of(20.0)


def prepared(observation):
    catalogue = catalogue_of_sky(SKY, observation.phase_centre)
    return Prepared.from_observation(observation, catalogue, OPTIONS)


def test_the_sources_are_placed_in_the_observation():
    found = prepared(changed(simulated_set()))
    np.testing.assert_allclose(found.field.l, SKY.l, atol=1e-12)
    assert found.first.summary.samples == found.field.summary.samples


def test_the_first_pass_is_a_stage():
    heard = Heard()
    observation = changed(simulated_set())
    catalogue = catalogue_of_sky(SKY, observation.phase_centre)
    Prepared.from_observation(observation, catalogue, OPTIONS, heard)
    assert heard.stages == ["first pass", "preparation"]
    count = sum(chunk.stokes_i.size for chunk in observation.chunks())
    assert [what for what in heard.all if what[0] == "advance"][-1] == ("advance", count, count)


def test_weights_that_are_to_agree_with_the_data_are_corrected_with_all_that_depends_on_them():
    raw = changed(simulated_set())
    first = prepared(ScaledObservation(raw, 5.0))
    better = first.with_noise_of_data(SKY, UvRange())
    assert better.observation.noise == pytest.approx(1.0, abs=0.03)
    expected = prepared(raw).field.summary.weight / better.observation.noise**2
    assert better.field.summary.weight == pytest.approx(expected, rel=1e-5)
    assert better.with_noise_of_data(SKY, UvRange()) is better


def test_weights_that_came_with_the_data_stay():
    found = prepared(changed(simulated_set(), ratio=3.0))
    assert found.with_noise_of_data(SKY, UvRange()) is found
