import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.summary import summarise
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet

FREQUENCY = np.array([299_792_458.0, 2 * 299_792_458.0])  # wavelengths of 1 m and 0.5 m


def _observation(weights):
    uvw = np.array([[3.0, 4.0, 9.0], [6.0, -8.0, 1.0], [300.0, 400.0, 0.0]])
    vis = np.zeros((3, 2), complex)
    blocks = (
        Visibilities(uvw[:2], FREQUENCY, vis[:2], weights[:2]),
        Visibilities(uvw[2:], FREQUENCY, vis[2:], weights[2:]),
    )
    return VisibilitySet(PhaseCentre(0.0, 0.0), blocks)


def test_what_carries_weight_is_counted_over_all_chunks():
    weights = np.array([[1.0, 2.0], [4.0, 0.0], [0.0, 0.0]])
    extent = summarise(_observation(weights))
    assert (extent.rows, extent.samples) == (3, 3)
    assert extent.weight == 7
    # the second row at 1 m and the first at 0.5 m; the third is flagged, w does not count
    assert extent.longest == pytest.approx(10)


def test_an_observation_that_is_all_flagged_is_an_error():
    with pytest.raises(
        InputError, match="all are flagged, have no positive weight, or have impossible values"
    ):
        summarise(_observation(np.zeros((3, 2))))


def test_an_observation_without_rows_is_an_error():
    with pytest.raises(InputError, match="no visibility carries weight"):
        summarise(VisibilitySet(PhaseCentre(0.0, 0.0), ()))
