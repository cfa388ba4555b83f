import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.skies import galaxies
from uvshear.predict.spectrum import TOLERANCE, SpectralExpansion

LOW, HIGH = 0.95e9, 1.76e9  # SKA-Mid's band 2


def _sky(indices):
    count = len(indices)
    l = np.linspace(0, 1e-3, count)
    return galaxies(l, 0.0, np.linspace(1.0, 2.0, count), beta=np.array(indices))


def _expanded(expansion, frequency):
    """Sum of the terms, in double precision and in the single precision of the package's own factors."""
    powers = (
        expansion.logarithm(frequency)[None, :].astype(float)
        ** np.arange(len(expansion.fluxes))[:, None]
    )
    return (expansion.fluxes.T @ powers) * expansion.gain(frequency)


@settings(deadline=None)
@given(st.lists(st.floats(-2.0, 1.5), min_size=1, max_size=6), st.floats(1.01, 1.86))
def test_the_expansion_is_each_sources_power_law_over_the_band(indices, ratio):
    sky = _sky(indices)
    frequency = np.linspace(LOW, ratio * LOW, 13)
    expansion = SpectralExpansion.of(sky, LOW, ratio * LOW)
    truth = sky.flux[:, None] * (frequency / sky.reference_frequency) ** sky.spectral_index[:, None]
    own = expansion.fluxes[0][:, None] * expansion.gain(frequency)
    # in units of the common power law: the tolerance, and what follows the first term left out
    error = np.abs(_expanded(expansion, frequency) - truth) / own
    assert error.max() < 1.5 * TOLERANCE


@settings(deadline=None)
@given(st.floats(-2.0, 2.0), st.integers(1, 5))
def test_sources_of_one_index_need_one_term(index, count):
    sky = _sky([index] * count)
    expansion = SpectralExpansion.of(sky, LOW, HIGH)
    np.testing.assert_allclose(expansion.fluxes, sky.flux[None, :], rtol=1e-12)
    frequency = np.array([LOW, 1.4e9, HIGH])
    np.testing.assert_allclose(expansion.gain(frequency), (frequency / 1.4e9) ** index, rtol=2e-7)


def test_a_wider_band_or_wider_indices_need_more_terms():
    near, far = _sky([-0.7, -0.7, -0.6]), _sky([-0.7, -0.7, 1.5])
    terms = [
        len(SpectralExpansion.of(sky, LOW, high).fluxes)
        for sky, high in ((near, 1.001 * LOW), (near, HIGH), (far, HIGH))
    ]
    assert terms[0] == 1
    assert terms[0] < terms[1] < terms[2]


def test_a_single_channel_needs_one_term_whatever_the_indices():
    expansion = SpectralExpansion.of(_sky([-0.7, 0.0, 2.0]), 1.2e9, 1.2e9)
    assert len(expansion.fluxes) == 1
    frequency = np.array([1.2e9])
    truth = _sky([-0.7, 0.0, 2.0])
    np.testing.assert_allclose(
        expansion.fluxes[0] * expansion.gain(frequency),
        truth.flux * (1.2e9 / 1.4e9) ** truth.spectral_index,
        rtol=2e-7,
    )


def test_the_common_index_is_the_median_and_the_frequency_the_middle_of_the_logarithms():
    expansion = SpectralExpansion.of(_sky([-0.7, -0.9, 2.0]), LOW, HIGH)
    assert expansion.index == -0.7
    assert expansion.frequency == pytest.approx(math.sqrt(LOW * HIGH))


def test_no_sources_expand_to_nothing():
    expansion = SpectralExpansion.of(_sky([-0.7]).select(np.zeros(0, int)), LOW, HIGH)
    assert expansion.fluxes.shape == (1, 0)
