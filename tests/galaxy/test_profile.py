import numpy as np
import pytest

from tests.galaxy.profile_battery import check_any_shape
from uvshear.galaxy import Profile


class OneLine(Profile):
    def envelope(self, q):
        return (1 + q) ** -2


def test_a_profile_of_ones_own_is_one_line():
    q = np.linspace(0, 9, 50)
    slope = OneLine().envelope_slope(q)
    np.testing.assert_allclose(slope[1:], -2 * (1 + q[1:]) ** -3, rtol=1e-6)
    assert abs(slope[0] + 2) < 1e-3  # one-sided at 0
    check_any_shape(OneLine())


def test_a_profile_without_an_envelope_cannot_be_made():
    with pytest.raises(TypeError, match="envelope"):
        type("Nothing", (Profile,), {})()
