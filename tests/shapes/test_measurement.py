import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uvshear.shapes.measurement import FitFlag, GalaxyFit, ShapeMeasurement


@settings(deadline=None)
@given(st.floats(1.0, 1e4), st.floats(0.0, 0.9))
def test_beyond_its_half_width_a_disc_is_lost_in_the_noise(snr, e):
    fit = GalaxyFit(1.0, np.zeros(2), complex(0, e), 2.0, snr)
    # along the long axis the brightness falls as exp(-r (1 - |e|)/alpha): by more than 1/snr, by e at least
    assert math.exp(-fit.half_width * (1 - e) / 2.0) <= 1 / snr / math.e * (1 + 1e-9)


def test_a_failure_carries_its_reason_and_no_numbers():
    failed = ShapeMeasurement.failed(FitFlag.NO_PEAK)
    assert failed.flag is FitFlag.NO_PEAK
    assert failed.best is None
    assert np.all(np.isnan(failed.ellipticity))
    assert math.isnan(failed.flux)
    assert math.isnan(failed.e_sigma)


@pytest.mark.parametrize("flag", FitFlag)
def test_flags_are_words_in_tables_and_sentences_for_people(flag):
    assert flag.word == flag.word.lower()
    assert FitFlag[flag.word.upper()] is flag
    assert flag is FitFlag.OK or " " in flag.value


def test_the_standard_deviation_is_that_of_a_circle_of_the_same_area():
    shape = ShapeMeasurement.failed(FitFlag.OK)
    covariance = np.array([[0.09, 0.01], [0.01, 0.04]])
    object.__setattr__(shape, "covariance", covariance)
    assert shape.e_sigma == pytest.approx(np.linalg.det(covariance) ** 0.25)
