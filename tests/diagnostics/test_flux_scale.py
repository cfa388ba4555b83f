"""The size of a catalogue's fluxes, judged by the data."""

import numpy as np
import pytest

from uvshear.diagnostics.flux_scale import flux_scale
from uvshear.interferometer.samples import Samples

COUNT = 4000
WEIGHT = 1e8


def _samples(vis, seed=1):
    rng = np.random.default_rng(seed)
    noise = (rng.standard_normal(COUNT) + 1j * rng.standard_normal(COUNT)) / np.sqrt(WEIGHT)
    return Samples(
        uvw=np.zeros((COUNT, 3)),
        stokes_i=(vis + noise).astype(np.complex64),
        weights=np.full(COUNT, WEIGHT, np.float32),
        frequency=np.full(COUNT, 1.4e9),
        bandwidth=np.zeros(COUNT, np.float32),
        interval=np.zeros(COUNT, np.float32),
        antennas=np.zeros((COUNT, 2), np.int16),
    )


def _sky(flux):
    rng = np.random.default_rng(2)
    return (flux * np.exp(2j * np.pi * rng.uniform(size=COUNT))).astype(np.complex64)


@pytest.mark.parametrize("wrong", [1e-6, 1e-3, 1e3, 1e6])
def test_another_unit_is_told(wrong):
    """The true source has a signal-to-noise ratio of 600."""
    scale = flux_scale(_samples(_sky(1e-3)), _sky(1e-3 / wrong))
    assert scale == pytest.approx(wrong, rel=0.02)


@pytest.mark.parametrize("factor", [0.05, 0.5, 1.0, 20.0])
def test_credible_fluxes_are_not_alarmed_about(factor):
    assert flux_scale(_samples(_sky(1e-3)), _sky(1e-3 * factor)) is None


def test_a_catalogue_of_a_field_without_signal_is_told_only_if_its_sources_would_be_seen():
    empty = _samples(0)
    assert flux_scale(empty, _sky(1e-7)) is None
    assert flux_scale(empty, _sky(1.0)) is not None
    assert flux_scale(empty, np.zeros(COUNT, np.complex64)) is None
