"""Facets: cells of the uv plane around one direction."""

import numpy as np

from uvshear.interferometer.facet import Facet

UV = np.array([[3.0, 4.0], [30.0, 40.0], [0.0, 1.0]])
FACET = Facet(UV, np.array([1 + 1j, 2.0, 3.0]), np.array([1.0, 2.0, 4.0]))


def test_cells_within_a_length_are_kept():
    near = FACET.within(5.0)
    np.testing.assert_array_equal(near.uv, UV[[0, 2]])
    np.testing.assert_array_equal(near.power, [1.0, 4.0])


def test_another_unit_of_the_flux_leaves_signal_to_noise_ratios():
    other = FACET.in_other_unit(1e-6)
    before = np.abs(FACET.correlation) / np.sqrt(FACET.power)
    np.testing.assert_allclose(np.abs(other.correlation) / np.sqrt(other.power), before)
    np.testing.assert_allclose(other.power, 1e-12 * FACET.power)


def test_a_facet_without_weights_or_without_cells_has_no_power():
    assert FACET.has_power
    assert not Facet(UV, FACET.correlation, np.zeros(3)).has_power
    assert not FACET.within(0.5).has_power
