"""What the data say about their weights and about the sign of UVW, by means of a sky."""

import warnings
from dataclasses import dataclass, replace

import numpy as np
import pytest

from tests.interferometer.chunks import CENTRE, chunk
from tests.pipeline.fields import METHOD, MODEL, catalogue_of_sky
from tests.pipeline.simulated_sets import changed, simulated_set, sky_of
from uvshear.errors import DataWarning
from uvshear.execution import Resources, Serial
from uvshear.extraction import Model, PaperExtraction
from uvshear.interferometer.first_pass import first_pass
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.origin import Origin
from uvshear.interferometer.scaled_observation import ScaledObservation, scaled_to_its_noise
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.pipeline.data_checks import DataChecks
from uvshear.pipeline.measure import measure

ARRAYS = ("ska-mid-aa4", "meerkat", "vla-a")
SETS = [(array, seconds) for array in ARRAYS for seconds in (60.0, 2400.0)]


def checks_of(observation, *, is_attenuated=True):
    samples = first_pass(observation).noise_samples
    return DataChecks(observation, samples, Model(), is_attenuated, Serial())


def notes(observation, sky, **more):
    return checks_of(observation, **more).noise_warnings(sky, UvRange())


@pytest.mark.parametrize(("array", "seconds"), SETS)
@pytest.mark.parametrize("brightest", [0.1, 20.0])
@pytest.mark.parametrize("has_hands", [True, False])
def test_right_weights_are_not_remarked_on_and_wrong_ones_are(array, seconds, brightest, has_hands):
    sky = sky_of(brightest)
    observation = simulated_set(array, seconds, sky)
    assert notes(changed(observation, has_hands=has_hands), sky) == ()
    # Weights that are 50 per cent off, and more.
    for ratio in (0.8, 1.25):
        (note,) = notes(changed(observation, ratio=ratio, has_hands=has_hands), sky)
        told = float(note.split("the noise is ")[1].split(" times what the weights claim")[0])
        # 5760 samples and their differences: 1 per cent; the smallest of several is low by as much
        assert told == pytest.approx(ratio, rel=0.05)


@pytest.mark.parametrize("has_hands", [True, False])
def test_a_source_that_the_catalogue_lacks_is_not_taken_for_noise(has_hands):
    observation = simulated_set()
    known = sky_of(20.0).select(slice(3))
    found = notes(changed(observation, has_hands=has_hands), known)
    if has_hands:
        assert found == ()
    else:
        (note,) = found
        assert "cannot be told" in note
        assert "times what the weights claim" not in note


@dataclass(frozen=True)
class Named(VisibilitySet):
    """A set that knows its name."""

    name: str = ""

    def origin(self):
        return Origin(self, self.name)


def test_each_part_is_told_under_its_own_name():
    good, loud = simulated_set(), changed(simulated_set(seed=2), ratio=2.0)
    parts = (
        Named(good.phase_centre, changed(good).blocks, "good.ms"),
        Named(loud.phase_centre, loud.blocks, "loud.ms"),
    )
    (note,) = notes(JointObservation(good.phase_centre, parts), sky_of(20.0))
    assert note.startswith(("loud.ms: the noise is 2", "loud.ms: the noise is 1.9"))


def test_scaled_parts_are_corrected_by_the_residual_and_others_are_left():
    first, second = changed(simulated_set()), changed(simulated_set(seed=2), ratio=2.0)
    scaled = ScaledObservation(second, 5.0)
    checks = checks_of(JointObservation(first.phase_centre, (first, scaled)))
    assert checks.takes_noise_from_data
    joint = checks.with_noise_of_data(sky_of(20.0), UvRange())
    assert joint.parts[0] is first
    assert joint.parts[1].noise == pytest.approx(2.0, rel=0.03)
    assert checks_of(joint).with_noise_of_data(sky_of(20.0), UvRange()) is None
    assert checks_of(joint).noise_warnings(sky_of(20.0), UvRange()) == ()
    assert not checks_of(first).takes_noise_from_data


def test_a_noise_that_sky_has_made_too_large_is_corrected_where_channels_bear_out_the_weights():
    """The scaled weights agree with the residual, in which a source is left; those that came do with its channels."""
    seen = chunk(1, integrations=300)
    varying = 30 * np.exp(2j * np.pi * np.random.default_rng(1).uniform(size=(len(seen), 1)))
    observation = VisibilitySet(CENTRE, (seen.with_stokes_i(seen.stokes_i + varying),))
    # The residual shows 28.5 times the noise that the weights imply, its differences in time 26.5, in frequency 0.99.
    checks = checks_of(ScaledObservation(observation, 27.2))
    better = checks.with_noise_of_data(replace(sky_of(20.0), flux=np.zeros(4)), UvRange())
    assert better.noise == pytest.approx(1.0, abs=0.04)


def signs(observation, sky):
    return checks_of(observation).sign_warnings(sky)


@pytest.mark.parametrize("turned", [{"sign": -1.0}, {"conjugates": True}])
def test_the_wrong_sign_of_uvw_is_told(turned):
    (note,) = signs(changed(simulated_set(), **turned), sky_of(20.0))
    assert note.startswith("the observation: the visibilities agree with the catalogue if UVW")
    assert "--conjugate" in note


@pytest.mark.parametrize("turned", [{}, {"sign": -1.0, "conjugates": True}])
@pytest.mark.parametrize("array", ARRAYS)
def test_the_right_sign_is_not_remarked_on_whatever_the_order_of_the_antennas(array, turned):
    """Opposite baselines with opposite phases, as LOFAR and WSRT store them, agree."""
    assert signs(changed(simulated_set(array), **turned), sky_of(20.0)) == ()


def test_an_empty_catalogue_tells_no_sign():
    assert signs(simulated_set(), replace(sky_of(20.0), flux=np.zeros(4))) == ()


def measured(observation, sky, **method):
    catalogue = catalogue_of_sky(sky, observation.phase_centre)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", DataWarning)
        shapes = measure(
            observation,
            catalogue,
            model=MODEL,
            method=replace(METHOD, **method),
            resources=Resources(Serial()),
        ).shapes
    return shapes, [str(warning.message) for warning in told]


@pytest.fixture(scope="module")
def right():
    """A bright sky whose visibilities change by many times the noise from sample to sample."""
    return simulated_set("vla-b", integration=2400.0)


def test_a_measurement_is_silent_about_right_weights_and_tells_wrong_ones(right):
    assert measured(changed(right), sky_of(20.0))[1] == []
    (note,) = measured(changed(right, ratio=1.25), sky_of(20.0))[1]
    assert "the residual of the fitted sky" in note


def test_errors_are_right_with_the_noise_of_the_data(right):
    """The first estimate, of neighbours, is many times too large."""
    scaled = scaled_to_its_noise(changed(right, ratio=0.5))
    assert scaled.noise > 5
    shapes, told = measured(scaled, sky_of(20.0))
    expected, _ = measured(changed(right), sky_of(20.0))
    assert told == []
    for name in ("e1_err", "flux_fit_err", "snr"):
        ok = expected["flag"] == "ok"
        assert np.count_nonzero(ok) == 3
        np.testing.assert_allclose(shapes[name][ok], expected[name][ok], rtol=0.04)


def test_the_papers_extraction_has_a_residual_too(right):
    sky = sky_of(20.0)
    assert measured(changed(right, has_hands=True), sky, extraction=PaperExtraction())[1] == []
    told = measured(changed(right, ratio=2.0, has_hands=True), sky, extraction=PaperExtraction())[1]
    (note,) = told
    assert "times what the weights claim" in note
