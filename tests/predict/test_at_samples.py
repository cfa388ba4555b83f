"""Visibilities at samples that each have a frequency of their own."""

import numpy as np
import pytest

from tests.interferometer.chunks import chunk
from tests.skies import galaxies
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.execution import Serial, Threads
from uvshear.galaxy import Exponential
from uvshear.interferometer.attenuation import total_attenuation
from uvshear.interferometer.samples import Samples
from uvshear.predict import predict_visibilities
from uvshear.predict.at_samples import predict_at_samples
from uvshear.predict.losses import Losses

SKY = galaxies(
    np.array([0.0, 20.0, -8.0]) * ARCMIN,
    np.array([3.0, 0.0, 9.0]) * ARCMIN,
    np.array([1.0, 2.0, 0.5]),
    np.array([2.0, 0.0, 5.0]) * ARCSEC,
    np.array([0.3, 0.0, -0.2 + 0.4j]),
    beta=np.array([-0.7, 0.4, -0.7]),
)


@pytest.mark.parametrize("is_attenuated", [False, True])
@pytest.mark.parametrize("executor", [Serial(), Threads(2)])
def test_samples_have_the_visibilities_of_their_rows_and_channels(is_attenuated, executor):
    seen = chunk(1, integrations=60)
    attenuation = total_attenuation(-0.5) if is_attenuated else None
    width = np.full(len(seen.frequency), 2e6)
    losses = Losses.from_attenuation(attenuation, width, seen.integrations)
    whole = predict_visibilities(SKY, seen.uvw, seen.frequency, losses=losses)
    row, chan = np.nonzero(seen.weights > 0)
    samples = Samples.at(seen, row, chan)
    samples = type(samples)(**{**vars(samples), "bandwidth": np.full(len(row), 2e6, np.float32)})
    found = predict_at_samples(SKY, samples, Exponential(), attenuation, executor)
    # measured 3e-7: single precision of the averaging
    np.testing.assert_allclose(found, whole[row, chan], rtol=0, atol=1e-5)
    if is_attenuated:
        bare = predict_at_samples(SKY, samples, Exponential())
        assert np.abs(found - bare).max() > 0.02


def test_nothing_is_predicted_for_nothing():
    samples = Samples.at(chunk(1), np.zeros(0, int), np.zeros(0, int))
    assert len(predict_at_samples(SKY, samples, Exponential())) == 0
