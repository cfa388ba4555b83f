"""Frames of other phase centres: phases and forms against those of the original frame."""

import numpy as np
import pytest

from uvshear.geometry.directions import n_minus_one
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.geometry.tangent_frame import TangentFrame

RNG = np.random.default_rng(5)
UVW = RNG.uniform(-3e4, 3e4, (40, 3))
L, M = RNG.uniform(-0.1, 0.1, (2, 7)) + np.array([[0.3], [-0.4]])


def _turns(uvw, l, m):
    return uvw @ np.stack([l, m, n_minus_one(l, m)])


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.3, -0.4), (-0.01, 0.02)])
def test_the_phase_of_every_direction_stays_the_same(centre):
    frame = TangentFrame.at(*centre)
    np.testing.assert_allclose(frame.rotation @ frame.rotation.T, np.eye(3), atol=1e-15)
    there = frame.directions(*(np.array([x]) for x in centre))
    np.testing.assert_allclose(there, 0, atol=1e-16)
    turned = _turns(frame.baselines(UVW), *frame.directions(L, M)) + frame.turns(UVW)[:, None]
    np.testing.assert_allclose(turned, _turns(UVW, L, M), rtol=0, atol=1e-9)


def test_a_form_has_the_same_value_at_the_same_baseline():
    frame = TangentFrame.at(0.3, -0.4)
    forms = np.stack(quadratic_form(RNG.uniform(-0.4, 0.4, 7) + 0.3j, np.full(7, 2e-6)), axis=-1)

    def value(uvw, l, m, forms):
        n = 1 + n_minus_one(l, m)
        u, v = (uvw[:, [axis]] - uvw[:, [2]] * x / n for axis, x in ((0, l), (1, m)))
        a, b, c = forms.T
        return a * u * u + b * u * v + c * v * v

    turned = frame.forms(L, M, forms)
    got = value(frame.baselines(UVW), *frame.directions(L, M), turned)
    np.testing.assert_allclose(got, value(UVW, L, M, forms), rtol=1e-12)
    assert np.abs(turned / forms - 1).max() > 0.1
