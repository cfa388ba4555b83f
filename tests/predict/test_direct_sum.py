"""The direct sum that has been planned."""

import numpy as np
import pytest

from tests.skies import galaxies, random_baselines
from uvshear.galaxy import Exponential
from uvshear.interferometer.attenuation import BandwidthSmearing
from uvshear.predict import predict_visibilities
from uvshear.predict.direct_sum import WITH_LOSSES, DirectSum
from uvshear.predict.losses import Losses

FREQUENCY = np.array([1.0e9, 1.3e9])
UVW = random_baselines(100, 2e4)
SKY = galaxies(l=[0.004, -0.01], m=[0.003, 0.002], flux=[1.0, 0.3])


def direct_sum(losses=None, dtype=np.float64, rows=100):
    return DirectSum(SKY, UVW[:rows], FREQUENCY, Exponential(), losses, dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("losses", [None, Losses(BandwidthSmearing(), np.array([2e6, 2e6]))])
def test_it_is_the_sum_over_the_galaxies(dtype, losses):
    expected = predict_visibilities(SKY, UVW, FREQUENCY, losses=losses, dtype=dtype)
    np.testing.assert_array_equal(direct_sum(losses, dtype).visibilities(), expected)


def test_its_cost_is_that_of_each_galaxy_and_visibility():
    assert direct_sum().cost == pytest.approx(2 * direct_sum(rows=50).cost)
    with_losses = direct_sum(Losses(BandwidthSmearing(), np.array([2e6, 2e6])))
    assert with_losses.cost == pytest.approx(WITH_LOSSES * direct_sum().cost)
