"""Smearing, against averages over finer channels and times."""

import math

import numpy as np
import pytest

from tests.interferometer.baselines import (
    DECLINATION,
    FREQUENCY,
    INTERVAL,
    PAIRS,
    WIDTH,
    L,
    M,
    baselines,
    samples,
)
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.geometry.directions import n_minus_one
from uvshear.interferometer.attenuation import (
    Attenuation,
    BandwidthSmearing,
    CellSmearing,
    CombinedAttenuation,
    TimeSmearing,
)
from uvshear.interferometer.averaged_rows import FOURTH, SECOND, permutations_of
from uvshear.interferometer.coverage import EARTH_ROTATION


def _averaged(*, over_channel, over_time):
    """Visibility of a point averaged over 41 x 41 frequencies and times, divided by that in the middle."""
    x = (np.arange(41) + 0.5) / 41 - 0.5
    hours = 0.4 + EARTH_ROTATION * INTERVAL * (x if over_time else np.zeros(1))
    frequency = FREQUENCY + WIDTH * (x if over_channel else np.zeros(1))
    direction = np.array([L, M, float(n_minus_one(np.array([L]), np.array([M]))[0])])
    delay = baselines(hours) @ direction / SPEED_OF_LIGHT
    middle = baselines(np.array([0.4])) @ direction / SPEED_OF_LIGHT * FREQUENCY
    turns = delay[..., None] * frequency - middle[..., None]
    return np.exp(2j * np.pi * turns).mean(axis=(1, 2))


@pytest.mark.parametrize(
    ("attenuation", "over"),
    [
        (BandwidthSmearing(), {"over_channel": True, "over_time": False}),
        (TimeSmearing(DECLINATION), {"over_channel": False, "over_time": True}),
        (
            CombinedAttenuation((BandwidthSmearing(), TimeSmearing(DECLINATION))),
            {"over_channel": True, "over_time": True},
        ),
    ],
)
def test_smearing_is_the_average_over_channel_and_integration(attenuation, over):
    exact = _averaged(**over)
    factor = attenuation.factor(samples(), L, M)
    assert factor.min() < 0.9
    # measured 2e-4 (both; the sum of the 41 x 41 is itself 1e-4 off); a sign of the rotation wrong: 0.5
    np.testing.assert_allclose(factor, exact.real, atol=6e-4)
    np.testing.assert_allclose(exact.imag, 0, atol=2e-3)


def test_nothing_is_smeared_at_the_phase_centre_or_where_widths_are_not_known():
    both = CombinedAttenuation((BandwidthSmearing(), TimeSmearing(DECLINATION)))
    nothing = np.zeros(PAIRS, np.float32)
    np.testing.assert_array_equal(both.factor(samples(), 0.0, 0.0), 1.0)
    unknown = samples(bandwidth=nothing, interval=nothing)
    np.testing.assert_array_equal(both.factor(unknown, L, M), 1.0)


class _Ramp(Attenuation):
    """An attenuation of a user, who defines its factor and nothing else."""

    def factor(self, samples, l, m):
        return np.linspace(0, 1, len(samples)) * (l + 2 * m)


@pytest.mark.parametrize(("dtype", "allowed"), [(np.float64, 1e-14), (np.float32, 1e-6)])
def test_prepared_attenuations_multiply_the_same_factors_for_several_sources(dtype, allowed):
    whole = CombinedAttenuation((BandwidthSmearing(), _Ramp(), TimeSmearing(DECLINATION)))
    prepared = whole.over(samples())
    l, m = np.array([L, 0.0, -2 * L]), np.array([M, 0.0, M])
    factors = np.full((3, PAIRS), 3.0, dtype)
    prepared.multiply(factors, l, m)
    assert factors.dtype == dtype
    for factor, *place in zip(factors, l.tolist(), m.tolist(), strict=True):
        expected = np.prod([part.factor(samples(), *place) for part in whole.parts], axis=0)
        np.testing.assert_allclose(factor, 3 * expected, rtol=0, atol=allowed)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_the_smearing_of_a_cell_is_the_average_over_it(dtype):
    rng = np.random.default_rng(2)
    l, m = np.array([L, -0.5 * L]), np.array([M, 0.8 * M])
    directions = np.stack([l, m, n_minus_one(l, m)], axis=-1)
    exact, moments = [], []
    for _ in range(PAIRS):
        # Evenly spread over a box that is turned in some way; up to 0.46 rad at the farther source.
        turned = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        spread = rng.uniform(-1, 1, (20_000, 3)) * (8, 5, 2) @ turned
        spread -= spread.mean(axis=0)
        exact.append(np.exp(2j * np.pi * spread @ directions.T).mean(axis=0))
        moments.append([np.mean(spread[:, a] * spread[:, b]) for a, b in SECOND])
    scatter = np.column_stack([moments, np.zeros((PAIRS, len(FOURTH)))])
    seen = samples(scatter=scatter.astype(np.float32))
    factors = np.ones((2, PAIRS), dtype)
    CellSmearing().over(seen).multiply(factors, l, m)
    assert factors.min() < 0.97
    np.testing.assert_allclose(factors, np.array(exact).real.T, rtol=0, atol=2.5e-4)


def test_a_form_of_fourth_degree_lowers_the_amplitude():
    rng = np.random.default_rng(3)
    fourth = rng.uniform(0, 1e6, (PAIRS, len(FOURTH)))
    seen = samples(scatter=np.column_stack([np.zeros((PAIRS, 6)), fourth]).astype(np.float32))
    direction = 2 * np.pi * np.array([L, M, math.sqrt(1 - L**2 - M**2) - 1])
    form = [permutations_of(place) * np.prod(direction[list(place)]) for place in FOURTH]
    expected = np.exp(-fourth @ form / 2)
    assert np.ptp(expected) > 0.01
    np.testing.assert_allclose(CellSmearing().factor(seen, L, M), expected, rtol=1e-5)


def test_samples_without_moments_are_not_smeared_in_cells():
    np.testing.assert_array_equal(CellSmearing().factor(samples(), L, M), 1.0)
