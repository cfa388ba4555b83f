"""The change that another major cycle would bring, in a shape's covariance and flag."""

from dataclasses import replace

import numpy as np
import pytest

from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.remaining_change import NOTICEABLE, RemainingChange, with_remaining_change

COVARIANCE = np.array([[4e-4, 1e-4], [1e-4, 3e-4]])
MEASURED = replace(
    ShapeMeasurement.failed(FitFlag.OK), ellipticity=np.array([0.1, 0.2]), covariance=COVARIANCE
)


@pytest.mark.parametrize(
    ("change", "flag"), [(0.9, FitFlag.OK), (1.1, FitFlag.NOT_CONVERGED), (0.0, FitFlag.OK)]
)
def test_a_noticeable_change_is_flagged_and_any_change_widens_the_error(change, flag):
    found = with_remaining_change(
        MEASURED, RemainingChange(change * NOTICEABLE, change * (0.01 - 0.02j))
    )
    assert found.flag is flag
    assert found.quality.remaining_change == change * NOTICEABLE
    added = change**2 * np.array([[1e-4, -2e-4], [-2e-4, 4e-4]])
    np.testing.assert_allclose(found.covariance, COVARIANCE + added, rtol=1e-12)


def test_a_reason_to_fail_stays_the_reason():
    failed = ShapeMeasurement.failed(FitFlag.NO_PEAK)
    found = with_remaining_change(failed, RemainingChange(3.0, 0.1 + 0j))
    assert found.flag is FitFlag.NO_PEAK
    assert np.isnan(found.covariance).all()
