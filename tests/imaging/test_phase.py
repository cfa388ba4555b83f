import numpy as np
import pytest

from tests.reference import direct_sum
from tests.skies import L_BAND, random_baselines, vla
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.imaging.phase import baselines_seen_from, shift_phase_centre

FREQUENCY = np.array([1.2e9, 1.5e9])
L, M = 0.009, -0.006


# dtype, error allowed (measured: 6e-8, 3e-12)
@pytest.mark.parametrize(("dtype", "allowed"), [(np.complex64, 5e-7), (np.complex128, 1e-11)])
def test_a_point_source_moved_to_the_phase_centre_is_its_flux_everywhere(dtype, allowed):
    uvw, _ = vla("a", samples=1)
    vis = direct_sum.point_sources(L, M, 2.0, uvw, FREQUENCY).astype(dtype)
    shifted = shift_phase_centre(uvw, FREQUENCY, vis, L, M)
    assert shifted.dtype == dtype
    # the sign of any of u, v, w wrong: 2
    np.testing.assert_allclose(shifted, np.full(vis.shape, 2.0), rtol=0, atol=2 * allowed)


def test_a_shift_keeps_every_modulus_and_none_changes_nothing():
    rng = np.random.default_rng(2)
    uvw = random_baselines(50, 5e3)
    vis = rng.normal(size=(50, 2)) + 1j * rng.normal(size=(50, 2))
    shifted = shift_phase_centre(uvw, FREQUENCY, vis, L, M)
    np.testing.assert_allclose(np.abs(shifted), np.abs(vis), rtol=1e-12)
    np.testing.assert_allclose(
        shift_phase_centre(uvw, FREQUENCY, vis, 0.0, 0.0), vis, rtol=0, atol=1e-15
    )


def test_conjugate_visibilities_undo_a_shift():
    rng = np.random.default_rng(2)
    uvw = random_baselines(50, 5e3)
    vis = rng.normal(size=(50, 2)) + 1j * rng.normal(size=(50, 2))
    there = shift_phase_centre(uvw, FREQUENCY, vis, L, M)
    back = shift_phase_centre(-uvw, FREQUENCY, there, L, M)
    np.testing.assert_allclose(back, vis, rtol=0, atol=1e-12)


@pytest.mark.parametrize("angle", np.linspace(0, 2 * np.pi, 5)[:-1])
def test_the_phase_around_a_source_is_that_of_the_baselines_seen_from_it(angle):
    uvw = random_baselines(200, 1e4, depth=1.0)
    step = 1e-6
    l, m = L + step * np.cos(angle), M + step * np.sin(angle)
    nearby = direct_sum.point_sources(l, m, 1.0, uvw, L_BAND)[:, 0]
    turns = np.angle(nearby / direct_sum.point_sources(L, M, 1.0, uvw, L_BAND)[:, 0]) / 2 / np.pi
    u, v, _ = baselines_seen_from(uvw, L, M).T * L_BAND[0] / SPEED_OF_LIGHT
    linear = u * (l - L) + v * (m - M)
    # measured 2e-8 turns, the second order; without the shift 4e-4, its sign wrong 8e-4
    np.testing.assert_allclose(turns, linear, rtol=0, atol=1e-7)
    unshifted = uvw[:, :2] @ (l - L, m - M) * L_BAND[0] / SPEED_OF_LIGHT
    assert np.abs(turns - unshifted).max() > 1e-4


def test_w_stays_as_it_is():
    uvw = random_baselines(20, 1e4)
    np.testing.assert_array_equal(baselines_seen_from(uvw, L, M)[:, 2], uvw[:, 2])
