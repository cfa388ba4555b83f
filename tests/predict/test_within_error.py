"""The choice of the way in which visibilities are predicted."""

import numpy as np
import pytest

from tests.skies import galaxies, random_baselines
from uvshear.constants import ARCSEC
from uvshear.galaxy import Exponential
from uvshear.interferometer.attenuation import BandwidthSmearing
from uvshear.predict import predict_visibilities
from uvshear.predict.losses import Losses
from uvshear.predict.within_error import predict_within_error

FREQUENCY = np.array([1.0e9, 1.3e9])
LOSSES = Losses(BandwidthSmearing(), np.array([2e6, 2e6]))


@pytest.mark.parametrize("losses", [None, LOSSES])
@pytest.mark.parametrize(("error", "most"), [(0.0, 1e-15), (1e-4, 1e-6)])
def test_the_error_decides_on_the_precision(losses, error, most):
    sky = galaxies(l=[0.004, -0.01], m=[0.003, 0.002], flux=[1.0, 0.3], alpha=ARCSEC)
    uvw = random_baselines(1000, 2e4)
    exact = predict_visibilities(sky, uvw, FREQUENCY, losses=losses)
    got = predict_within_error(sky, uvw, FREQUENCY, error, Exponential(), losses=losses)
    wrong = np.abs(got - exact).max()
    assert most / 1000 < wrong < most if error else wrong <= most
